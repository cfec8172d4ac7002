#include "cli/progress_json.hpp"

#include <iostream>
#include <sstream>

#include "write/text_file.hpp"

namespace grainvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Names of files may hold any bytes; JSON is UTF-8.
std::string line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

Json progress_json(const Progress& progress, double seconds_so_far) {
  Json json{{"doing", progress.doing},
            {"frames_done", progress.frames_done},
            {"frames_total", progress.frames_total},
            {"seconds", seconds_so_far}};
  if (!progress.error.empty()) json["error"] = progress.error;
  if (progress.frames_done > 0 && progress.frames_total > 0) {
    const double done = static_cast<double>(progress.frames_done) / static_cast<double>(progress.frames_total);
    json["seconds_left"] = seconds_so_far * (1 - done) / done;
  }
  return json;
}

void SparseView::show(const Progress& progress) {
  constexpr std::chrono::seconds apart(1);
  const Clock::time_point now = Clock::now();
  if (last_ && progress.frames_done < progress.frames_total && now - *last_ < apart) return;
  last_ = now;
  write(progress_json(progress, std::chrono::duration<double>(now - start_).count()));
}

void ProgressFile::write(const Json& progress) {
  write_text_file(path_, line(progress));
}

void ProgressLog::write(const Json& progress) {
  log_event("progress", progress);
}

void log_event(const std::string& event, const Json& what) {
  Json json{{"event", event}};
  json.update(what);
  std::cerr << line(json) << std::flush;
}

void log_warnings(const std::string& warnings) {
  const std::string prefix = "grainvdb: warning: ";
  std::istringstream lines(warnings);
  for (std::string text; std::getline(lines, text);)
    log_event("warning", {{"message", text.starts_with(prefix) ? text.substr(prefix.size()) : text}});
}

}  // namespace grainvdb::cli
