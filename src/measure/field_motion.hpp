#pragma once
/// The coarse-grained velocity about which grains fluctuate, between voxel centres.
#include <cstdint>
#include <optional>
#include <vector>

#include "grainvdb/flow.hpp"
#include "grainvdb/lattice.hpp"

namespace grainvdb {

struct OutputFields;

class FieldMotion {
 public:
  explicit FieldMotion(const Lattice& lattice) : lattice_(lattice) {}

  /// Keeps the velocity of an output time.
  void take(const OutputFields& output);

  /// Whether some output time has frames before and after `step`, or is that frame.
  bool covers(std::int64_t step) const { return at_step(step) != nullptr; }

  /// u(x) [length/time], trilinear, of the first output time that covers `step`; nothing without one, and where one of
  /// the eight voxels around x has no velocity.
  std::optional<Vec3> at(std::int64_t step, const Vec3& x) const;

 private:
  struct Span {
    std::int64_t first, last;
    FlowGrid velocity;
  };
  const Span* at_step(std::int64_t step) const;

  Lattice lattice_;
  std::vector<Span> spans_;
};

}  // namespace grainvdb
