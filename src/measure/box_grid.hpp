#pragma once
/// Equal boxes that fill space.
#include <array>
#include <cstdint>

#include "grainvdb/box.hpp"

namespace grainvdb {

/// The number of a box along each axis.
using BoxIndex = std::array<std::int64_t, 3>;

/// Along a periodic axis as many boxes as fit the period best, at least one, stretched to fill it; along any other
/// boxes of the wanted edge that begin at the origin.
class BoxGrid {
 public:
  /// Throws std::invalid_argument unless the edges are positive and finite.
  BoxGrid(const Vec3& edge, const Box& box, const Vec3& origin);

  const Vec3& edge() const { return edge_; }
  /// The box that holds x, or the image of x along periodic axes.
  BoxIndex index(const Vec3& x) const;
  Vec3 centre(const BoxIndex& index) const;
  /// x less the centre of its box, of the image that lies in the box.
  Vec3 offset(const Vec3& x) const;

 private:
  Vec3 wrapped(const Vec3& x) const;

  Box box_;
  Vec3 edge_, start_;
};

}  // namespace grainvdb
