#pragma once
/// Wall time by step of the run.
#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace grainvdb {

class Stopwatch {
 public:
  /// Runs f and adds its wall time to the named step; returns what f returns.
  template <class F>
  auto time(const std::string& step, F&& f) {
    struct Guard {
      Stopwatch& watch;
      const std::string& step;
      std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
      ~Guard() { watch.add(step, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()); }
    } guard{*this, step};
    return std::forward<F>(f)();
  }

  /// Step → seconds, in the order in which the steps first ran.
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

 private:
  void add(const std::string& step, double s) {
    const auto it =
        std::find_if(seconds_.begin(), seconds_.end(), [&](const auto& entry) { return entry.first == step; });
    if (it == seconds_.end()) {
      seconds_.emplace_back(step, s);
    } else {
      it->second += s;
    }
  }
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace grainvdb
