#include "cli/progress_line.hpp"

#include <cmath>

#include <unistd.h>

namespace grainvdb::cli {
namespace {

std::string duration(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  if (whole < 60) return std::to_string(whole) + " s";
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

}  // namespace

std::string progress_text(const Progress& progress, double seconds_so_far) {
  std::string text =
      progress.doing + ": " + std::to_string(progress.frames_done) + '/' + std::to_string(progress.frames_total);
  if (!progress.error.empty()) text += ", " + progress.error;
  if (progress.frames_done == 0 || progress.frames_total == 0) return text;
  const double done = static_cast<double>(progress.frames_done) / static_cast<double>(progress.frames_total);
  return text + " (" + std::to_string(static_cast<int>(100 * done)) + " %), " +
         duration(seconds_so_far * (1 - done) / done) + " left";
}

ProgressLine::ProgressLine(std::FILE* stream) : stream_(stream), is_terminal_(isatty(fileno(stream)) == 1) {}

ProgressLine::~ProgressLine() {
  if (!shown_) return;
  std::fputs("\r\033[K", stream_);
  std::fflush(stream_);
}

void ProgressLine::show(const Progress& progress) {
  if (!is_terminal_) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  std::fprintf(stream_, "\r\033[K%s", progress_text(progress, elapsed.count()).c_str());
  std::fflush(stream_);
  shown_ = true;
}

}  // namespace grainvdb::cli
