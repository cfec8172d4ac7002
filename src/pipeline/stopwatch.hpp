#pragma once
/// Time by step of the run.
#include <algorithm>
#include <chrono>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace grainvdb {

/// Steps may overlap: each counts its own time, so that all together may exceed the time that has passed.
class Stopwatch {
 public:
  /// Runs f and adds its time to the named step; returns what f returns. Concurrent calls are safe.
  template <class F>
  auto time(const std::string& step, F&& f) {
    struct Guard {
      Stopwatch& watch;
      const std::string& step;
      std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
      ~Guard() { watch.add(step, seconds_since(start)); }
    } guard{*this, step};
    return std::forward<F>(f)();
  }

  /// Step → seconds, in the order in which the steps first ended.
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }
  /// Since the watch was made.
  double passed() const { return seconds_since(start_); }

 private:
  static double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  void add(const std::string& step, double s) {
    const std::lock_guard lock(mutex_);
    const auto it =
        std::find_if(seconds_.begin(), seconds_.end(), [&](const auto& entry) { return entry.first == step; });
    if (it == seconds_.end()) {
      seconds_.emplace_back(step, s);
    } else {
      it->second += s;
    }
  }
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace grainvdb
