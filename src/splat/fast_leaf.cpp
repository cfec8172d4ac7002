#include "splat/fast_leaf.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace grainvdb {
namespace {

/// Sums in double, once more.
class SumsInDouble final : public DoubtfulSums {
 public:
  SumsInDouble(const FastLeafSplat& splat, const Coord& origin, LeafWork& work)
      : splat_(splat), origin_(origin), work_(work) {}
  void take(const DoubtfulBrick& brick) override { splat_.sum_again(origin_, brick, work_); }

 private:
  const FastLeafSplat& splat_;
  const Coord& origin_;
  LeafWork& work_;
};

}  // namespace

const double* FastLeafSplat::run(const Coord& origin, const LeafMask& active, LeafWork& work) const {
  work.values.resize(channels_ * leaf_size);
  run_to(origin, active, work, {}, [&](std::size_t c) { return work.values.data() + c * leaf_size; });
  return work.values.data();
}

void FastLeafSplat::run(const Coord& origin, const LeafMask& active, LeafWork& work, std::span<float* const> to) const {
  run_to(origin, active, work, to, [&](std::size_t c) { return to[c]; });
}

template <class To>
void FastLeafSplat::run_to(const Coord& origin, const LeafMask& active, LeafWork& work, std::span<float* const> far,
                           const To& to) const {
  gather_candidates(buckets_, origin, cutoff_, work.candidates);
  if (work.candidates.count == 0) {  // a species is not everywhere that there are voxels
    for (std::size_t c = 0; c < channels_; ++c) std::fill_n(to(c), leaf_size, 0);
    return;
  }
  records_.gather(origin, work.candidates, work.records);
  work.largest.resize(channels_);
  for (std::size_t c = 0; c < channels_; ++c)
    work.largest[c] = work.records.reference[c] == 0 ? work.records.largest[c] : 0;
  work.again.clear();
  SumsInDouble doubtful(*this, origin, work);
  LeafSplat leaf{&work.candidates, work.records.values.data(), records_.stride(), static_cast<int>(channels_), voxel()};
  leaf.to = far;
  leaf.doubtful = &doubtful;
  leaf.largest = work.largest.data();
  splat_leaf(leaf, active, work.sums);
  scale(active, work, to);
  for (const SumInDouble& sum : work.again)
    to(sum.channel)[sum.offset] = static_cast<std::remove_pointer_t<decltype(to(0))>>(sum.value);
}

template <class To>
void FastLeafSplat::scale(const LeafMask& active, const LeafWork& work, const To& to) const {
  const double peak = kernel_.value(0) / summed_part;
  const auto row = [](std::size_t channel) { return static_cast<int>(1 + channel); };
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::size_t w = weight_[c];
    scale_sums(work.sums.sums, {row(c), peak * scale_[c], row(w), peak * scale_[w] * work.records.reference[c]}, active,
               to(c));
  }
}

// Positions in double; the values in single precision are exact enough.
void FastLeafSplat::sum_again(const Coord& origin, const DoubtfulBrick& brick, LeafWork& work) const {
  work.exact.resize(records_.stride());
  for (std::uint32_t lanes = brick.any; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    const std::int32_t offset = brick.voxels[lane];
    find_terms(buckets_, work.candidates, {brick.chosen, brick.count}, origin, offset, lattice_.voxel(), kernel_,
               work.terms);
    sum_terms(work.terms, work.records.values.data(), records_.stride(), work.exact.data());
    for (std::size_t c = 0; c < channels_; ++c) {
      if ((brick.lanes[c] >> lane & 1U) == 0) continue;
      const std::size_t w = weight_[c];
      const double sum = scale_[c] * work.exact[c];
      const double mean = work.records.reference[c] * scale_[w] * work.exact[w];
      work.again.push_back({c, offset, sum + mean});
    }
  }
}

}  // namespace grainvdb
