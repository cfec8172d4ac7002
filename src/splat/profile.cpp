#include "splat/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/parallel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat/profile.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>
//
#include "splat/bricks-inl.hpp"

#ifndef GRAINVDB_SPLAT_PLANE_PIECE
#define GRAINVDB_SPLAT_PLANE_PIECE
namespace grainvdb {

// Planes that are summed together, and the most candidates whose sums single precision is trusted with.
constexpr int planes_per_group = 16;
constexpr float middle_plane = 7.5F;
constexpr std::size_t candidates_per_piece = 512;

// A group of planes and some of its candidates. Positions are relative to the group's middle, in units of the cutoff.
struct PlanePiece {
  const float* z;
  const float* q;  // [candidate][stride]
  std::size_t count;
  std::size_t stride;
  int channels;
  float spacing;  // of the planes, in units of the cutoff
  float* weights;
  float* plain;  // [plane]
  float* sums;   // [channel][plane]
};

}  // namespace grainvdb
#endif

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace {

/// A brick of planes: `lanes` of them one after another. The marginal is w₁ ~ (1-ζ)⁴ (1 + 4ζ + 5ζ²).
void SumPlanes(const PlanePiece& piece, const std::int32_t* all) {
  const V one = hn::Set(d, 1.0F), four = hn::Set(d, 4.0F), five = hn::Set(d, 5.0F);
  HWY_ALIGN float sums[widest * lanes];
  for (int first = 0; first < planes_per_group; first += lanes) {
    const V at = hn::Mul(hn::Set(d, piece.spacing), hn::Iota(d, static_cast<float>(first) - middle_plane));
    V plain = hn::Zero(d);
    for (std::size_t k = 0; k < piece.count; ++k) {
      const V zeta = hn::Min(hn::Abs(hn::Sub(at, hn::Set(d, piece.z[k]))), one);
      const V p = hn::Sub(one, zeta);
      const V p2 = hn::Mul(p, p);
      const V w = hn::Mul(hn::Mul(p2, p2), hn::MulAdd(hn::MulAdd(five, zeta, four), zeta, one));
      plain = hn::Add(plain, w);
      hn::Store(w, d, piece.weights + k * lanes);
    }
    hn::StoreU(plain, d, piece.plain + first);
    for (int c = 0; c < piece.channels; c += widest) {
      const int now = piece.channels - c < widest ? piece.channels - c : widest;
      sum_of(static_cast<std::size_t>(now), piece.stride)(piece.weights, piece.q + c, piece.stride, all, piece.count,
                                                          sums);
      for (int k = 0; k < now; ++k)
        hn::StoreU(hn::Load(d, sums + k * lanes), d, piece.sums + (c + k) * planes_per_group + first);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {
HWY_EXPORT(SumPlanes);
namespace {

// A rounding of δ = 1.5e-7 c changes w₁ by a factor 4 δ/(1-ζ): too much for the terms with 1-ζ < 0.06, each of which is
// less than 1.3e-4 w₁(0). They matter only where a sum is this small against the number of its terms, and is formed
// again in double:
constexpr double faint_part = 2e-4;

// Images of the particles, sorted by the group of planes they lie in.
struct PlaneEntries {
  std::int32_t first_group = 0;
  std::vector<std::size_t> start;  // of each group
  std::vector<double> index;       // position in index space
  std::vector<std::uint32_t> point;
};

std::int32_t group_of(double index) {
  return static_cast<std::int32_t>(std::floor((index + 0.5) / planes_per_group));
}

PlaneEntries sort_entries(const Lattice& lattice, int axis, const std::vector<double>& position, double reach) {
  std::vector<double> index;
  std::vector<std::uint32_t> point;
  const auto& period = lattice.period(axis);
  for (std::size_t p = 0; p < position.size(); ++p) {
    const double u = lattice.wrap_index(axis, lattice.to_index(axis, position[p]));
    if (!(std::abs(u) + 2 * reach < std::numeric_limits<std::int32_t>::max() - 4 * planes_per_group))
      throw std::invalid_argument("position " + std::to_string(position[p]) + " does not fit the voxel index range");
    const double n = period ? period->count : 1;
    const double first = period ? std::ceil((period->first - reach - u) / n) : 0;
    const double last = period ? std::floor((period->first + n - 1 + reach - u) / n) : 0;
    for (double k = first; k <= last; ++k) {
      index.push_back(u + k * n);
      point.push_back(static_cast<std::uint32_t>(p));
    }
  }
  std::vector<std::uint32_t> order(index.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return group_of(index[a]) < group_of(index[b]); });
  PlaneEntries sorted;
  sorted.first_group = index.empty() ? 0 : group_of(index[order.front()]);
  const std::size_t groups =
      index.empty() ? 0 : static_cast<std::size_t>(group_of(index[order.back()]) - sorted.first_group) + 1;
  sorted.start.assign(groups + 1, 0);
  for (const std::uint32_t e : order) {
    sorted.index.push_back(index[e]);
    sorted.point.push_back(point[e]);
    ++sorted.start[static_cast<std::size_t>(group_of(index[e]) - sorted.first_group) + 1];
  }
  std::partial_sum(sorted.start.begin(), sorted.start.end(), sorted.start.begin());
  return sorted;
}

class PlaneSplat {
 public:
  PlaneSplat(const LucyKernel& kernel, const Lattice& lattice, const PlaneEntries& entries, std::span<const double> q,
             std::size_t channels)
      : kernel_(kernel),
        h_(lattice.voxel()),
        reach_(kernel.cutoff() / lattice.voxel()),
        entries_(entries),
        q_(q),
        channels_(channels),
        scale_(channels) {
    for (std::size_t n = 0; n < q.size(); ++n) scale_[n % channels] = std::max(scale_[n % channels], std::abs(q[n]));
    for (double& s : scale_)
      if (s == 0) s = 1;
  }

  /// The sums of one group, [plane][channel].
  std::vector<double> group(std::int32_t number) const {
    const auto [begin, end] = candidates(number);
    const std::int32_t first = number * planes_per_group;
    std::vector<double> sums(planes_per_group * channels_);
    std::vector<double> plain(planes_per_group);
    for (std::size_t from = begin; from < end; from += candidates_per_piece)
      add_piece(first, from, std::min(end, from + candidates_per_piece), sums, plain);
    const double peak = kernel_.marginal(0);
    const double few = faint_part * static_cast<double>(end - begin);
    for (std::size_t p = 0; p < planes_per_group; ++p)
      for (std::size_t c = 0; c < channels_; ++c) {
        double& sum = sums[p * channels_ + c];
        sum = plain[p] < few || std::abs(sum) < few ? in_double(first + static_cast<std::int32_t>(p), c, begin, end)
                                                    : sum * peak * scale_[c];
      }
    return sums;
  }

 private:
  /// The entries of all groups that the group's planes can see.
  std::pair<std::size_t, std::size_t> candidates(std::int32_t number) const {
    const double low = number * planes_per_group - reach_;
    const double high = number * planes_per_group + planes_per_group - 1 + reach_;
    const auto groups = static_cast<std::int64_t>(entries_.start.size()) - 1;
    const auto from = std::clamp<std::int64_t>(group_of(low) - std::int64_t{entries_.first_group}, 0, groups);
    const auto to = std::clamp<std::int64_t>(group_of(high) - std::int64_t{entries_.first_group} + 1, 0, groups);
    return {entries_.start[static_cast<std::size_t>(from)], entries_.start[static_cast<std::size_t>(to)]};
  }

  void add_piece(std::int32_t first, std::size_t begin, std::size_t end, std::vector<double>& sums,
                 std::vector<double>& plain) const {
    const std::size_t count = end - begin;
    const std::size_t stride = (channels_ + 3) / 4 * 4;
    Grow<float> z, q, weights, plain_part, part;
    Grow<std::int32_t> all;
    PlanePiece piece{z.room(count),
                     q.room(count * stride),
                     count,
                     stride,
                     static_cast<int>(channels_),
                     static_cast<float>(1 / reach_),
                     weights.room(count * planes_per_group),
                     plain_part.room(planes_per_group),
                     part.room(channels_ * planes_per_group)};
    std::int32_t* const places = all.room(count);
    std::iota(places, places + count, 0);
    for (std::size_t k = 0; k < count; ++k) {
      z[k] = static_cast<float>((entries_.index[begin + k] - first - middle_plane) / reach_);
      const double* from = q_.data() + entries_.point[begin + k] * channels_;
      for (std::size_t c = 0; c < stride; ++c)
        q[k * stride + c] = c < channels_ ? static_cast<float>(from[c] / scale_[c]) : 0.0F;
    }
    HWY_DYNAMIC_DISPATCH(SumPlanes)(piece, places);
    for (std::size_t p = 0; p < planes_per_group; ++p) {
      plain[p] += static_cast<double>(plain_part[p]);
      for (std::size_t c = 0; c < channels_; ++c)
        sums[p * channels_ + c] += static_cast<double>(part[c * planes_per_group + p]);
    }
  }

  double in_double(std::int32_t plane, std::size_t channel, std::size_t begin, std::size_t end) const {
    double sum = 0;
    for (std::size_t e = begin; e < end; ++e)
      sum += q_[entries_.point[e] * channels_ + channel] * kernel_.marginal((plane - entries_.index[e]) * h_);
    return sum;
  }

  const LucyKernel& kernel_;
  double h_;
  double reach_;
  const PlaneEntries& entries_;
  std::span<const double> q_;
  std::size_t channels_;
  std::vector<double> scale_;
};

}  // namespace

PlaneSums splat_planes(const Lattice& lattice, const LucyKernel& kernel, int axis, const std::vector<double>& position,
                       std::span<const double> q, int channels) {
  const auto width = static_cast<std::size_t>(channels);
  if (channels < 1 || q.size() != position.size() * width)
    throw std::invalid_argument("the splat needs one value per point and channel");
  PlaneSums sums;
  sums.channels = channels;
  const double reach = kernel.cutoff() / lattice.voxel();
  const PlaneEntries entries = sort_entries(lattice, axis, position, reach);
  if (entries.index.empty()) return sums;

  const auto [least, greatest] = std::minmax_element(entries.index.begin(), entries.index.end());
  sums.first = static_cast<std::int32_t>(std::floor(*least - reach)) + 1;
  std::int32_t last = static_cast<std::int32_t>(std::ceil(*greatest + reach)) - 1;
  if (const auto& period = lattice.period(axis)) {
    sums.first = std::max(sums.first, period->first);
    last = std::min(last, period->first + period->count - 1);
  }
  sums.values.resize(static_cast<std::size_t>(last - sums.first + 1) * width);

  const PlaneSplat splat(kernel, lattice, entries, q, width);
  const std::int32_t from = group_of(sums.first);
  parallel_for(static_cast<std::size_t>(group_of(last) - from + 1), [&](std::size_t g) {
    const std::int32_t number = from + static_cast<std::int32_t>(g);
    const std::vector<double> group = splat.group(number);
    for (std::int32_t p = 0; p < planes_per_group; ++p) {
      const std::int32_t plane = number * planes_per_group + p;
      if (plane < sums.first || plane > last) continue;
      std::copy_n(group.begin() + static_cast<std::ptrdiff_t>(p) * channels, width,
                  sums.values.begin() + static_cast<std::ptrdiff_t>(plane - sums.first) * channels);
    }
  });
  return sums;
}

}  // namespace grainvdb
#endif
