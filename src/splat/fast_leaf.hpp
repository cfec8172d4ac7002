#pragma once
/// The fast particle splat of one leaf, whatever the values that are summed: brick sums in single precision, and sums
/// in double where those cannot be trusted.
#include <cstddef>
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

/// What one thread needs on the way; reused from leaf to leaf.
struct LeafWork {
  LeafCandidates candidates;
  LeafRecords records;
  LeafSums sums;
  Picked near;                     // candidates of a block with voxels to be summed again
  ExactTerms terms;                // of one such voxel
  std::vector<double> exact;       // their sums
  std::vector<LeafMask> faint;     // of each channel
  std::vector<float> limits, few;  // of each channel
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
        cutoff_(kernel.cutoff() / lattice.voxel()) {}

  /// The sums of one leaf, [channel][offset], 0 where inactive; they lie in `work`.
  const double* run(const Coord& origin, const LeafMask& active, LeafWork& work) const;
  /// The same in single precision, to the 512 values of each channel.
  void run(const Coord& origin, const LeafMask& active, LeafWork& work, std::span<float* const> to) const;

 private:
  float voxel() const { return static_cast<float>(1 / cutoff_); }
  const float* sum(const LeafWork& work, std::size_t channel) const {
    return work.sums.sums.data() + channel * leaf_size;
  }
  /// `far`: where the values go if that memory is not in the cache.
  template <class To>
  void run_to(const Coord& origin, const LeafMask& active, LeafWork& work, std::span<float* const> far,
              const To& to) const;
  template <class To>
  void scale(const LeafMask& active, const LeafWork& work, const To& to) const;
  LeafMask find_faint(const LeafMask& active, LeafWork& work) const;
  template <class To>
  void sum_again(const Coord& origin, const LeafMask& active, LeafWork& work, const To& to) const;
  template <class To>
  void sum_in_double(const Coord& origin, int offset, LeafWork& work, const To& to) const;

  const Lattice& lattice_;
  const LucyKernel& kernel_;
  const Buckets& buckets_;
  const RecordSource& records_;
  std::size_t channels_;
  double cutoff_;  ///< in voxels
};

}  // namespace grainvdb
