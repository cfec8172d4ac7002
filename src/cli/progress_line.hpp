#pragma once
/// One line of progress that is rewritten in place, with the time that remains.
#include <chrono>
#include <cstdio>
#include <string>

#include "cli/progress_view.hpp"

namespace grainvdb::cli {

/// "frames 3/10 (30 %), 12 s left": the remaining time if every frame takes as long as those done.
std::string progress_text(const Progress& progress, double seconds_so_far);

/// Writes to a terminal; does nothing when the stream is not one.
class ProgressLine final : public ProgressView {
 public:
  explicit ProgressLine(std::FILE* stream);
  ~ProgressLine() override;
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const Progress& progress) override;

 private:
  std::FILE* stream_;
  bool is_terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace grainvdb::cli
