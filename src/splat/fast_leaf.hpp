#pragma once
/// The fast particle splat of one leaf, whatever the values that are summed: brick sums in single precision, and sums
/// in double where those cannot be trusted.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/topology.hpp"
#include "splat/bricks.hpp"
#include "splat/candidates.hpp"
#include "splat/exact_terms.hpp"
#include "splat/records.hpp"

namespace grainvdb {

/// A sum that took the place of one in single precision.
struct SumInDouble {
  std::size_t channel;
  std::int32_t offset;  // of its voxel in the leaf
  double value;
};

/// What one thread needs on the way; reused from leaf to leaf.
struct LeafWork {
  LeafCandidates candidates;
  LeafRecords records;
  std::vector<float> largest;  // |value| of each channel without a reference
  LeafSums sums;
  ExactTerms terms;                // of a voxel that is summed again
  std::vector<double> exact;       // its sums
  std::vector<SumInDouble> again;  // those of them that were in doubt
  std::vector<double> values;      // [channel][offset]
};

class FastLeafSplat {
 public:
  /// All must outlive the splat.
  FastLeafSplat(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets, const RecordSource& records)
      : lattice_(lattice),
        kernel_(kernel),
        buckets_(buckets),
        records_(records),
        channels_(records.channels()),
        cutoff_(kernel.cutoff() / lattice.voxel()) {
    for (std::size_t c = 0; c < channels_; ++c) {
      scale_.push_back(records.scale(c));
      weight_.push_back(records.weight(c));
    }
  }

  /// The sums of one leaf, [channel][offset], 0 where inactive; they lie in `work`.
  const double* run(const Coord& origin, const LeafMask& active, LeafWork& work) const;
  /// The same in single precision, to the 512 values of each channel.
  void run(const Coord& origin, const LeafMask& active, LeafWork& work, std::span<float* const> to) const;
  /// Adds the doubtful sums of a brick, in double precision, to `again` of the work.
  void sum_again(const Coord& origin, const DoubtfulBrick& brick, LeafWork& work) const;

 private:
  float voxel() const { return static_cast<float>(1 / cutoff_); }
  /// `far`: where the values go if that memory is not in the cache.
  template <class To>
  void run_to(const Coord& origin, const LeafMask& active, LeafWork& work, std::span<float* const> far,
              const To& to) const;
  template <class To>
  void scale(const LeafMask& active, const LeafWork& work, const To& to) const;

  const Lattice& lattice_;
  const LucyKernel& kernel_;
  const Buckets& buckets_;
  const RecordSource& records_;
  std::size_t channels_;
  double cutoff_;              ///< in voxels
  std::vector<double> scale_;  ///< of each channel, as the records have them
  std::vector<std::size_t> weight_;
};

}  // namespace grainvdb
