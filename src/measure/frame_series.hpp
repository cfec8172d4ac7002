#pragma once
/// The column that rows of one frame each are drawn against.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/table.hpp"

namespace grainvdb {

class FrameSeries {
 public:
  void add(const Frame& frame) {
    steps_.push_back(static_cast<double>(frame.step));
    times_.push_back(frame.time.value_or(std::numeric_limits<double>::quiet_NaN()));
  }

  /// The times of the frames; their steps where not every frame has a time.
  TableColumn column() const {
    if (std::all_of(times_.begin(), times_.end(), [](double t) { return std::isfinite(t); }))
      return {"time", dimension::time, "time of the frame", times_};
    return {"step", dimension::none, "time step of the frame", steps_};
  }

 private:
  std::vector<double> steps_, times_;
};

}  // namespace grainvdb
