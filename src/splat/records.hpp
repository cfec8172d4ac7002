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

/// The records of a leaf's candidates about references of the leaf, and what they are made of.
struct LeafRecords {
  Grow<float> values;             ///< [candidate][stride]
  std::vector<double> reference;  ///< r of each channel; 0 without one
  std::vector<float> largest;     ///< |value| of each channel
  std::vector<float> shift;       ///< scratch
  Vec3 about{};                   ///< what the vectors were measured from that products are made of
};

/// Where the fast splat finds the values of a leaf's candidates.
class RecordSource {
 public:
  virtual ~RecordSource() = default;
  virtual std::size_t channels() const = 0;
  /// Of the records: `channels` rounded up to whole vectors.
  virtual std::size_t stride() const = 0;
  /// What a value of 1 stands for.
  virtual double scale(std::size_t channel) const = 0;
  /// The channel that weighs the reference of a channel; itself where it has none.
  virtual std::size_t weight(std::size_t channel) const = 0;
  virtual void gather(const Coord& leaf, const LeafCandidates& candidates, LeafRecords& out) const = 0;
};

/// Records [entry][stride] of w (q - r)/scale, where r is a reference of the entry's cell: the mean of q over the cell
/// when every q certainly lies within half of it, else 0. So |q| is at least half the reference wherever there is one,
/// and the rounding of w (q - r) stays small against |w q|. `scale` is about the largest |w q| of a channel over the
/// frame: units do not matter to the range of single precision.
class Records final : public RecordSource {
 public:
  /// `q` is laid out [point][channel]; `weight_of[c]` is the channel that weighs channel c, or -1.
  Records(const Buckets& buckets, std::span<const double> q, std::span<const int> weight_of);

  std::size_t channels() const override { return channels_; }
  std::size_t stride() const override { return stride_; }
  double scale(std::size_t channel) const override { return scale_[channel]; }
  std::size_t weight(std::size_t channel) const override { return weight_[channel]; }
  void gather(const Coord& leaf, const LeafCandidates& candidates, LeafRecords& out) const override;

 private:
  double leaf_reference(const Coord& leaf, const LeafCandidates& candidates, std::size_t channel) const;

  const Buckets& buckets_;
  std::size_t channels_;
  std::size_t stride_;
  std::vector<std::size_t> weight_;
  std::vector<WeighedChannels> weighed_;
  std::vector<double> scale_;
  Grow<float> values_;
  std::vector<double> reference_;  // [cell][channel]
  std::vector<double> spread_;     // [cell][channel], no |q - r| of the cell is larger
};

}  // namespace grainvdb
