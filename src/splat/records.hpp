#pragma once
/// The values of a splat in single precision, one record per entry, about references that keep what single precision
/// would lose.
#include <cstddef>
#include <span>
#include <vector>

#include "bin/buckets.hpp"
#include "splat/candidates.hpp"
#include "splat/grow.hpp"

namespace grainvdb {

/// Channels weighed by one other: Σ w q W for the weight w in channel `weight`.
struct WeighedChannels {
  std::size_t weight = 0;
  std::vector<std::size_t> channels;
};

/// Records [entry][stride] of w (q - r)/scale, where r is a reference of the entry's cell: the mean of q over the cell
/// when every q certainly lies within half of it, else 0. So |q| is at least half the reference wherever there is one,
/// and the rounding of w (q - r) stays small against |w q|. `scale` is the largest |w q| of a channel over the frame:
/// units do not matter to the range of single precision.
class Records {
 public:
  /// `q` is laid out [point][channel]; `weight_of[c]` is the channel that weighs channel c, or -1.
  Records(const Buckets& buckets, std::span<const double> q, std::span<const int> weight_of);

  std::size_t channels() const { return channels_; }
  std::size_t stride() const { return stride_; }
  double scale(std::size_t channel) const { return scale_[channel]; }

  /// The records of a leaf's candidates about references of the leaf, and what they are made of.
  struct OfLeaf {
    Grow<float> values;             ///< [candidate][stride]
    std::vector<double> reference;  ///< r of each channel; 0 without one
    std::vector<float> largest;     ///< |value| of each channel
    std::vector<float> shift;       ///< scratch
  };
  void gather(const Coord& leaf, const LeafCandidates& candidates, OfLeaf& out) const;

 private:
  void choose_references(std::size_t cell, const WeighedChannels& weighed, std::span<const double> q);
  double leaf_reference(const Coord& leaf, const LeafCandidates& candidates, std::size_t channel) const;

  const Buckets& buckets_;
  std::size_t channels_;
  std::size_t stride_;
  std::vector<WeighedChannels> weighed_;
  std::vector<double> scale_;
  Grow<float> values_;
  std::vector<double> reference_;  // [cell][channel]
  std::vector<double> spread_;     // [cell][channel], no |q - r| of the cell is larger
};

}  // namespace grainvdb
