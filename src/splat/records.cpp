#include "splat/records.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/records.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/bricks-inl.hpp"

#ifndef GRAINVDB_SPLAT_RECORD_COPY
#define GRAINVDB_SPLAT_RECORD_COPY
namespace grainvdb {

// Copies records, adding `shift` times the record's weight; keeps the largest magnitudes.
struct RecordCopy {
  const float* from;
  const std::uint32_t* entry;
  std::size_t count;
  std::size_t stride;
  const float* shift;  // [weight][stride]
  const std::size_t* weight;
  std::size_t weights;
  float* to;
  float* largest;
};

}  // namespace grainvdb
#endif

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

void CopyRecords(const RecordCopy& copy) {
  const hn::CappedTag<float, 4> d4;  // records are padded to four
  for (std::size_t k = 0; k < copy.count; ++k) {
    const float* HWY_RESTRICT from = copy.from + copy.entry[k] * copy.stride;
    float* HWY_RESTRICT to = copy.to + k * copy.stride;
    const auto copy_part = [&](auto tag, std::size_t c) {
      auto v = hn::LoadU(tag, from + c);
      for (std::size_t w = 0; w < copy.weights; ++w)
        v = hn::MulAdd(hn::LoadU(tag, copy.shift + w * copy.stride + c), hn::Set(tag, from[copy.weight[w]]), v);
      hn::StoreU(v, tag, to + c);
      hn::StoreU(hn::Max(hn::LoadU(tag, copy.largest + c), hn::Abs(v)), tag, copy.largest + c);
    };
    std::size_t c = 0;
    for (; c + lanes <= copy.stride; c += lanes) copy_part(d, c);
    for (; c < copy.stride; c += hn::Lanes(d4)) copy_part(d4, c);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(CopyRecords);

namespace {

std::vector<WeighedChannels> by_weight(std::span<const int> weight_of) {
  std::vector<WeighedChannels> all;
  for (std::size_t c = 0; c < weight_of.size(); ++c) {
    if (weight_of[c] < 0) continue;
    const auto weight = static_cast<std::size_t>(weight_of[c]);
    const auto same = [&](const WeighedChannels& w) { return w.weight == weight; };
    auto it = std::find_if(all.begin(), all.end(), same);
    if (it == all.end()) it = all.insert(all.end(), {weight, {}});
    it->channels.push_back(c);
  }
  return all;
}

// One value alone, two, or a multiple of four.
std::size_t stride_for(std::size_t channels) {
  return (channels + 3) / 4 * 4;
}

}  // namespace

Records::Records(const Buckets& buckets, std::span<const double> q, std::span<const int> weight_of)
    : buckets_(buckets),
      channels_(weight_of.size()),
      stride_(stride_for(weight_of.size())),
      weighed_(by_weight(weight_of)),
      scale_(channels_, 0.0),
      reference_(buckets.cells.size() * channels_),
      spread_(buckets.cells.size() * channels_) {
  for (std::size_t n = 0; n < q.size(); n += channels_)
    for (std::size_t c = 0; c < channels_; ++c) scale_[c] = std::max(scale_[c], std::abs(q[n + c]));
  for (double& scale : scale_)
    if (scale == 0) scale = 1;

  float* const values = values_.room(buckets.point.size() * stride_);
  parallel_for(buckets.cells.size(), [&](std::size_t cell) {
    const std::size_t begin = buckets.start[cell];
    const std::size_t end = buckets.start[cell + 1];
    choose_references(cell, begin, end, q, buckets);
    const double* reference = reference_.data() + cell * channels_;
    for (std::size_t e = begin; e < end; ++e) {
      const double* from = q.data() + buckets.point[e] * channels_;
      float* to = values + e * stride_;
      for (std::size_t c = 0; c < channels_; ++c) to[c] = static_cast<float>(from[c] / scale_[c]);
      for (std::size_t c = channels_; c < stride_; ++c) to[c] = 0;
      for (const WeighedChannels& w : weighed_)
        for (const std::size_t c : w.channels)
          to[c] = static_cast<float>((from[c] - reference[c] * from[w.weight]) / scale_[c]);
    }
  });
}

void Records::choose_references(std::size_t cell, std::size_t begin, std::size_t end, std::span<const double> q,
                                const Buckets& buckets) {
  const auto value = [&](std::size_t e, std::size_t c) { return q[buckets.point[e] * channels_ + c]; };
  for (const WeighedChannels& w : weighed_)
    for (const std::size_t c : w.channels) {
      double above = 0;
      double below = 0;
      for (std::size_t e = begin; e < end; ++e) {
        above += value(e, c);
        below += value(e, w.weight);
      }
      if (!(below > 0)) continue;
      const double mean = above / below;
      double spread = 0;
      for (std::size_t e = begin; e < end; ++e)
        spread = std::max(spread, std::abs(value(e, c) / value(e, w.weight) - mean));
      if (!(spread <= 0.5 * std::abs(mean))) continue;
      reference_[cell * channels_ + c] = mean;
      spread_[cell * channels_ + c] = spread;
    }
}

double Records::leaf_reference(const Coord& leaf, const LeafCandidates& candidates, std::size_t channel) const {
  const auto of_cell = [&](std::size_t cell) { return reference_[cell * channels_ + channel]; };
  double mean = 0;
  for (const CellRange& range : candidates.cells) {
    if (of_cell(range.cell) == 0) return 0;
    mean += of_cell(range.cell) / static_cast<double>(candidates.cells.size());
    if (buckets_.cells[range.cell] == leaf) {
      mean = of_cell(range.cell);
      break;
    }
  }
  for (const CellRange& range : candidates.cells) {
    const double apart = std::abs(of_cell(range.cell) - mean) + spread_[range.cell * channels_ + channel];
    if (of_cell(range.cell) == 0 || !(apart <= 0.5 * std::abs(mean))) return 0;
  }
  return mean;
}

void Records::gather(const Coord& leaf, const LeafCandidates& candidates, OfLeaf& out) const {
  float* const to = out.values.room(candidates.count * stride_);
  out.reference.assign(channels_, 0.0);
  out.largest.assign(stride_, 0.0F);
  out.shift.resize(weighed_.size() * stride_);
  std::vector<std::size_t> weights;
  for (const WeighedChannels& w : weighed_) {
    weights.push_back(w.weight);
    for (const std::size_t c : w.channels) out.reference[c] = leaf_reference(leaf, candidates, c);
  }
  for (const CellRange& range : candidates.cells) {
    std::fill(out.shift.begin(), out.shift.end(), 0.0F);
    for (std::size_t w = 0; w < weighed_.size(); ++w)
      for (const std::size_t c : weighed_[w].channels) {
        const double apart = reference_[range.cell * channels_ + c] - out.reference[c];
        out.shift[w * stride_ + c] = static_cast<float>(apart * scale_[weighed_[w].weight] / scale_[c]);
      }
    HWY_DYNAMIC_DISPATCH(CopyRecords)
    ({values_.data(), candidates.entry.data() + range.begin, range.end - range.begin, stride_, out.shift.data(),
      weights.data(), weights.size(), to + range.begin * stride_, out.largest.data()});
  }
}

}  // namespace grainvdb
#endif
