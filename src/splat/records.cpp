#include "splat/records.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/enumerable_thread_specific.h>

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

// Values in double precision, [row][stride].
struct Rows {
  const double* values;
  std::size_t count;
  std::size_t stride;
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

constexpr hn::CappedTag<double, 4> doubles;  // rows are padded to four
constexpr hn::Rebind<float, decltype(doubles)> singles;

// For every channel of some rows their sum and the least of them.
void SumRows(const Rows& rows, double* HWY_RESTRICT sums, double* HWY_RESTRICT least) {
  for (std::size_t c = 0; c < rows.stride; c += hn::Lanes(doubles)) {
    auto sum = hn::Zero(doubles), low = hn::Set(doubles, hwy::HighestValue<double>());
    for (std::size_t k = 0; k < rows.count; ++k) {
      const auto v = hn::LoadU(doubles, rows.values + k * rows.stride + c);
      sum = hn::Add(sum, v);
      low = hn::Min(low, v);
    }
    hn::StoreU(sum, doubles, sums + c);
    hn::StoreU(low, doubles, least + c);
  }
}

// For every channel the largest |value - mean · weight|.
void SpreadOfRows(const Rows& rows, const double* HWY_RESTRICT mean, std::size_t weight, double* HWY_RESTRICT apart) {
  for (std::size_t c = 0; c < rows.stride; c += hn::Lanes(doubles)) {
    const auto middle = hn::LoadU(doubles, mean + c);
    auto largest = hn::Zero(doubles);
    for (std::size_t k = 0; k < rows.count; ++k) {
      const double* HWY_RESTRICT row = rows.values + k * rows.stride;
      const auto v = hn::NegMulAdd(middle, hn::Set(doubles, row[weight]), hn::LoadU(doubles, row + c));
      largest = hn::Max(largest, hn::Abs(v));
    }
    hn::StoreU(largest, doubles, apart + c);
  }
}

// (value - reference · weight) · inverse in single precision, where the references of different weights are apart.
void NarrowRows(const Rows& rows, const double* HWY_RESTRICT references, const std::size_t* HWY_RESTRICT weights,
                std::size_t weight_count, const double* HWY_RESTRICT inverse, float* HWY_RESTRICT to) {
  for (std::size_t k = 0; k < rows.count; ++k) {
    const double* HWY_RESTRICT row = rows.values + k * rows.stride;
    for (std::size_t c = 0; c < rows.stride; c += hn::Lanes(doubles)) {
      auto v = hn::LoadU(doubles, row + c);
      for (std::size_t w = 0; w < weight_count; ++w)
        v = hn::NegMulAdd(hn::LoadU(doubles, references + w * rows.stride + c), hn::Set(doubles, row[weights[w]]), v);
      hn::StoreU(hn::DemoteTo(singles, hn::Mul(v, hn::LoadU(doubles, inverse + c))), singles, to + k * rows.stride + c);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(CopyRecords);
HWY_EXPORT(SumRows);
HWY_EXPORT(SpreadOfRows);
HWY_EXPORT(NarrowRows);

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

/// The unit of each channel over all points.
std::vector<double> scales(std::span<const double> q, std::size_t channels) {
  constexpr std::size_t points = 4096;  // of a part
  const std::size_t step = points * channels;
  const std::size_t parts = (q.size() + step - 1) / step;
  std::vector<double> of_part(parts * channels);
  parallel_for(parts, [&](std::size_t part) {
    double* largest = of_part.data() + part * channels;
    const std::size_t end = std::min((part + 1) * step, q.size());
    for (std::size_t n = part * step; n < end; n += channels)
      for (std::size_t c = 0; c < channels; ++c) largest[c] = std::max(largest[c], std::abs(q[n + c]));
  });
  std::vector<double> scale(channels, 0.0);
  for (std::size_t n = 0; n < of_part.size(); n += channels)
    for (std::size_t c = 0; c < channels; ++c) scale[c] = std::max(scale[c], of_part[n + c]);
  for (double& s : scale) s = unit_of(s);
  return scale;
}

/// Scratch of a cell.
struct CellWork {
  std::vector<double> rows;                     // of its entries
  std::vector<double> sums, least;              // of each channel
  std::vector<double> mean, apart, references;  // [weight][stride]
};

/// Collects the rows of a cell's entries. They lie scattered over the points: each is asked for some rows ahead.
Rows rows_of(const Buckets& buckets, std::size_t cell, std::span<const double> q, std::size_t channels,
             std::size_t stride, std::vector<double>& to) {
  constexpr std::size_t ahead = 12;
  constexpr std::size_t line = 64 / sizeof(double);
  const std::size_t begin = buckets.start[cell];
  const std::size_t count = buckets.start[cell + 1] - begin;
  const auto row = [&](std::size_t k) { return q.data() + buckets.point[begin + k] * channels; };
  to.resize(count * stride);
  for (std::size_t k = 0; k < count; ++k) {
    if (k + ahead < count) {
      for (std::size_t c = 0; c < channels; c += line) __builtin_prefetch(row(k + ahead) + c);
      __builtin_prefetch(row(k + ahead) + channels - 1);
    }
    // By hand: rows are too short for the calls that library functions make.
    double* const copy = to.data() + k * stride;
    for (std::size_t c = 0; c < channels; ++c) copy[c] = row(k)[c];
    for (std::size_t c = channels; c < stride; ++c) copy[c] = 0;
  }
  return {to.data(), count, stride};
}

}  // namespace

Records::Records(const Buckets& buckets, std::span<const double> q, std::span<const int> weight_of)
    : buckets_(buckets),
      channels_(weight_of.size()),
      stride_((weight_of.size() + 3) / 4 * 4),
      weight_(channels_),
      weighed_(by_weight(weight_of)),
      scale_(scales(q, weight_of.size())),
      reference_(buckets.cells.size() * channels_),
      spread_(buckets.cells.size() * channels_) {
  for (std::size_t c = 0; c < channels_; ++c)
    weight_[c] = weight_of[c] < 0 ? c : static_cast<std::size_t>(weight_of[c]);
  std::vector<double> inverse(stride_, 0.0);
  for (std::size_t c = 0; c < channels_; ++c) inverse[c] = 1 / scale_[c];
  std::vector<std::size_t> weights;
  for (const WeighedChannels& w : weighed_) weights.push_back(w.weight);

  float* const values = values_.room(buckets.point.size() * stride_);
  tbb::enumerable_thread_specific<CellWork> works;
  parallel_for(buckets.cells.size(), [&](std::size_t cell) {
    CellWork& work = works.local();
    const Rows rows = rows_of(buckets, cell, q, channels_, stride_, work.rows);
    work.references.assign(weights.size() * stride_, 0.0);
    if (!weights.empty()) {
      work.sums.resize(stride_);
      work.least.resize(stride_);
      work.mean.resize(stride_);
      work.apart.resize(stride_);
      HWY_DYNAMIC_DISPATCH(SumRows)(rows, work.sums.data(), work.least.data());
      for (std::size_t w = 0; w < weights.size(); ++w) {
        const double least = work.least[weights[w]];
        if (!(least > 0)) continue;
        for (std::size_t c = 0; c < stride_; ++c) work.mean[c] = work.sums[c] / work.sums[weights[w]];
        HWY_DYNAMIC_DISPATCH(SpreadOfRows)(rows, work.mean.data(), weights[w], work.apart.data());
        for (const std::size_t c : weighed_[w].channels) {
          const double spread = work.apart[c] / least;
          if (!(spread <= 0.5 * std::abs(work.mean[c]))) continue;
          work.references[w * stride_ + c] = reference_[cell * channels_ + c] = work.mean[c];
          spread_[cell * channels_ + c] = spread;
        }
      }
    }
    HWY_DYNAMIC_DISPATCH(NarrowRows)
    (rows, work.references.data(), weights.data(), weights.size(), inverse.data(),
     values + buckets.start[cell] * stride_);
  });
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
