#include "splat/records.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "splat/value_unit.hpp"

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

// One part of all records, as wide as the tag. The largest magnitudes stay in a register.
template <class Tag>
void CopyPart(const RecordCopy& copy, Tag tag, std::size_t c) {
  auto largest = hn::LoadU(tag, copy.largest + c);
  const float* HWY_RESTRICT from = copy.from + c;
  float* HWY_RESTRICT to = copy.to + c;
  if (copy.weights == 1) {
    const auto shift = hn::LoadU(tag, copy.shift + c);
    const float* HWY_RESTRICT weight = copy.from + copy.weight[0];
    for (std::size_t k = 0; k < copy.count; ++k) {
      const std::size_t at = copy.entry[k] * copy.stride;
      const auto v = hn::MulAdd(shift, hn::Set(tag, weight[at]), hn::LoadU(tag, from + at));
      hn::StoreU(v, tag, to + k * copy.stride);
      largest = hn::Max(largest, hn::Abs(v));
    }
  } else {
    for (std::size_t k = 0; k < copy.count; ++k) {
      const std::size_t at = copy.entry[k] * copy.stride;
      auto v = hn::LoadU(tag, from + at);
      for (std::size_t w = 0; w < copy.weights; ++w)
        v = hn::MulAdd(hn::LoadU(tag, copy.shift + w * copy.stride + c), hn::Set(tag, copy.from[at + copy.weight[w]]),
                       v);
      hn::StoreU(v, tag, to + k * copy.stride);
      largest = hn::Max(largest, hn::Abs(v));
    }
  }
  hn::StoreU(largest, tag, copy.largest + c);
}

void CopyRecords(const RecordCopy& copy) {
  const hn::CappedTag<float, 4> d4;  // records are padded to four
  std::size_t c = 0;
  for (; c + lanes <= copy.stride; c += lanes) CopyPart(copy, d, c);
  for (; c < copy.stride; c += hn::Lanes(d4)) CopyPart(copy, d4, c);
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

}  // namespace

Records::Records(const Buckets& buckets, std::span<const double> q, std::span<const int> weight_of)
    : buckets_(buckets),
      channels_(weight_of.size()),
      stride_((weight_of.size() + 3) / 4 * 4),
      weight_(channels_),
      weighed_(by_weight(weight_of)),
      scale_(channels_, 0.0),
      reference_(buckets.cells.size() * channels_),
      spread_(buckets.cells.size() * channels_) {
  for (std::size_t c = 0; c < channels_; ++c)
    weight_[c] = weight_of[c] < 0 ? c : static_cast<std::size_t>(weight_of[c]);
  for (std::size_t n = 0; n < q.size(); n += channels_)
    for (std::size_t c = 0; c < channels_; ++c) scale_[c] = std::max(scale_[c], std::abs(q[n + c]));
  std::vector<double> inverse(channels_);
  for (std::size_t c = 0; c < channels_; ++c) {
    scale_[c] = unit_of(scale_[c]);
    inverse[c] = 1 / scale_[c];
  }

  float* const values = values_.room(buckets.point.size() * stride_);
  parallel_for(buckets.cells.size(), [&](std::size_t cell) {
    const std::size_t begin = buckets.start[cell];
    const std::size_t end = buckets.start[cell + 1];
    for (const WeighedChannels& w : weighed_) choose_references(cell, w, q);
    const double* reference = reference_.data() + cell * channels_;
    for (std::size_t e = begin; e < end; ++e) {
      const double* from = q.data() + buckets.point[e] * channels_;
      float* to = values + e * stride_;
      for (std::size_t c = 0; c < channels_; ++c) to[c] = static_cast<float>(from[c] * inverse[c]);
      for (std::size_t c = channels_; c < stride_; ++c) to[c] = 0;
      for (const WeighedChannels& w : weighed_)
        for (const std::size_t c : w.channels)
          to[c] = static_cast<float>((from[c] - reference[c] * from[w.weight]) * inverse[c]);
    }
  });
}

void Records::choose_references(std::size_t cell, const WeighedChannels& weighed, std::span<const double> q) {
  const std::size_t begin = buckets_.start[cell];
  const std::size_t end = buckets_.start[cell + 1];
  const auto record = [&](std::size_t e) { return q.data() + buckets_.point[e] * channels_; };
  double least = std::numeric_limits<double>::infinity();  // of the weights
  double weights = 0;
  for (std::size_t e = begin; e < end; ++e) {
    const double w = record(e)[weighed.weight];
    least = std::min(least, w);
    weights += w;
  }
  if (!(least > 0)) return;
  for (const std::size_t c : weighed.channels) {
    double sum = 0;
    for (std::size_t e = begin; e < end; ++e) sum += record(e)[c];
    const double mean = sum / weights;
    double apart = 0;  // largest |w (q - mean)|
    for (std::size_t e = begin; e < end; ++e)
      apart = std::max(apart, std::abs(record(e)[c] - mean * record(e)[weighed.weight]));
    const double spread = apart / least;
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

void Records::gather(const Coord& leaf, const LeafCandidates& candidates, LeafRecords& out) const {
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
