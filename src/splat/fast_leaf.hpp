#pragma once
/// The fast particle splat of one leaf, whatever the values that are summed: brick sums in single precision, and sums
/// in double where those cannot be trusted.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/topology.hpp"
#include "splat/bricks.hpp"
#include "splat/candidates.hpp"
#include "splat/grow.hpp"
#include "splat/records.hpp"

namespace grainvdb {

/// What one thread needs on the way; reused from leaf to leaf.
struct LeafWork {
  LeafCandidates candidates;
  LeafRecords records;
  LeafSums sums;
  Picked near;                  // candidates of a block with voxels to be summed again
  Grow<std::int32_t> places;    // of those near such a voxel
  std::vector<LeafMask> faint;  // of each channel
  std::vector<ExactTerm> terms;
  std::vector<double> exact;       // their sums
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

 private:
  float voxel() const { return static_cast<float>(1 / cutoff_); }
  const float* sum(const LeafWork& work, std::size_t channel) const {
    return work.sums.sums.data() + channel * leaf_size;
  }
  void scale(const LeafMask& active, LeafWork& work) const;
  LeafMask find_faint(const LeafMask& active, LeafWork& work) const;
  void sum_again(const Coord& origin, const LeafMask& active, LeafWork& work) const;
  void sum_in_double(const Coord& at, std::size_t offset, std::size_t near, LeafWork& work) const;

  const Lattice& lattice_;
  const LucyKernel& kernel_;
  const Buckets& buckets_;
  const RecordSource& records_;
  std::size_t channels_;
  double cutoff_;  ///< in voxels
};

}  // namespace grainvdb
