#pragma once
/// Which grains touch, by distance or by a contact dump, and what follows from that alone.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "grainvdb/frame.hpp"

namespace grainvdb {

/// Grain i touches partner[start[i]] … partner[start[i+1]-1].
struct ContactGraph {
  static constexpr std::uint32_t outside = std::numeric_limits<std::uint32_t>::max();  ///< a grain that is not counted

  std::vector<std::size_t> start{0};
  std::vector<std::uint32_t> partner;
  std::vector<Vec3> branch;  ///< from the centre of i to that of its partner; empty for contact dumps [length]

  std::size_t size() const { return start.size() - 1; }
  std::size_t degree(std::size_t i) const { return start[i + 1] - start[i]; }
};

/// Grains whose surfaces are at most `gap` apart: |x_i - x_j| - r_i - r_j ≤ gap.
ContactGraph contacts_by_gap(const Box& box, const Columns3& position, const std::vector<double>& radius, double gap);

/// The contacts of a dump. Those with grains that are not among the particles count for the one that is.
ContactGraph contacts_of_dump(const Particles& particles, const Contacts& contacts);

/// Which grains remain when those with fewer than `least` contacts are taken out, and then those that have fewer
/// without them, until none has (the `least`-core of the graph). Grains outside stay.
std::vector<bool> backbone(const ContactGraph& graph, std::size_t least);

/// Angles between pairs of contacts of one grain, in equal bins of 0 … π.
class BondAngles {
 public:
  explicit BondAngles(std::size_t bins) : counts_(bins) {}

  /// All pairs of contacts of grain i.
  void add(const ContactGraph& graph, std::size_t i);

  std::size_t bins() const { return counts_.size(); }
  double edge(std::size_t k) const;
  double count(std::size_t k) const { return counts_[k]; }
  double total() const;
  /// Share of the angles, per radian.
  double density(std::size_t k) const;
  /// The same over that of directions without any preference, (cos θ₁ - cos θ₂)/2 from θ₁ to θ₂.
  double relative(std::size_t k) const;

 private:
  std::vector<double> counts_;
};

}  // namespace grainvdb
