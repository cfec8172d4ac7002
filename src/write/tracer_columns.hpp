#pragma once
/// What files of tracers hold besides positions: names, units and meanings that all formats share.
#include <cstddef>
#include <string>
#include <vector>

#include "grainvdb/tracer_sink.hpp"

namespace grainvdb {

/// A quantity that each sample gives for every tracer as double numbers.
struct TracerNumbers {
  std::string name;
  std::string unit;
  std::string description;
  std::string equation;
  std::vector<const std::vector<double>*> values;  ///< per component, [tracer]; of the sample it was made for
};

/// Displacement, then strain, courant and gradient_number where the sample has them.
std::vector<TracerNumbers> numbers_of(const TracerSample& sample, const TracerLayout& layout);

/// All stop codes, in ascending order.
const std::vector<TracerStop>& tracer_stops();

/// Keeps watch that samples are as announced, and alike.
class TracerSampleCheck {
 public:
  /// Throws std::invalid_argument when there is no tracer.
  explicit TracerSampleCheck(const TracerLayout& layout);
  /// Throws std::invalid_argument when a column has another length than the layout says, or when the optional columns
  /// or the order in time differ from those of the sample before.
  void check(const TracerSample& sample);
  std::size_t samples() const { return samples_; }

 private:
  std::vector<std::size_t> field_sizes_;
  std::size_t tracers_;
  std::size_t samples_ = 0;
  std::vector<std::string> names_;
  double last_time_ = 0;
};

}  // namespace grainvdb
