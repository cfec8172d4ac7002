#pragma once
/// Progress for programs: batch systems that look into a file, and logs of JSON lines.
#include <chrono>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "cli/progress_view.hpp"

namespace grainvdb::cli {

/// doing, frames_done, frames_total, seconds and, once there is something to go by, seconds_left.
nlohmann::ordered_json progress_json(const Progress& progress, double seconds_so_far);

/// Shows no more than one progress a second, but always the first and the last.
class SparseView : public ProgressView {
 public:
  void show(const Progress& progress) final;

 protected:
  virtual void write(const nlohmann::ordered_json& progress) = 0;

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  std::optional<Clock::time_point> last_;
};

/// A file that always holds the last progress, whole.
class ProgressFile final : public SparseView {
 public:
  explicit ProgressFile(std::string path) : path_(std::move(path)) {}

 protected:
  /// Throws IoError.
  void write(const nlohmann::ordered_json& progress) override;

 private:
  std::string path_;
};

/// Lines on the standard error.
class ProgressLog final : public SparseView {
 protected:
  void write(const nlohmann::ordered_json& progress) override;
};

/// One line on the standard error: an object whose first member is the event.
void log_event(const std::string& event, const nlohmann::ordered_json& what);

/// One line for each line of warnings.
void log_warnings(const std::string& warnings);

}  // namespace grainvdb::cli
