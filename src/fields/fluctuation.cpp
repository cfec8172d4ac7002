#include "fields/fluctuation.hpp"

#include <algorithm>
#include <cstddef>

#include "fields/moments.hpp"
#include "grainvdb/topology.hpp"

namespace grainvdb {
namespace {

double square_distance(const Columns3& q, std::size_t i, const Vec3& mean) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) sum += (q[a][i] - mean[a]) * (q[a][i] - mean[a]);
  return sum;
}

Moment deviation_moment(const Fluctuating& f, const std::string& mode) {
  Moment m;
  m.name = "volume " + f.label + " fluctuation " + mode;
  m.columns = Column::radius | f.column;
  m.frame_needs = {f.mean_numerator, f.mean_denominator};
  return m;
}

/// q_α: V |q_α - q̃(x_α)|² with q̃ sampled by `sample`.
template <class Sample>
std::function<void(const FrameView&, std::span<double>)> deviations(Columns3 Particles::*vector, Sample sample) {
  return [vector, sample](const FrameView& view, std::span<double> q) {
    const Particles& p = view.particles();
    const std::vector<Vec3> mean = sample(view);
    for (std::size_t i = 0; i < p.size(); ++i)
      q[i] = sphere_volume(p.radius[i]) * square_distance(p.*vector, i, mean[i]);
  };
}

MomentPtr two_pass(const Fluctuating& f) {
  Moment m = deviation_moment(f, "two_pass");
  m.values = deviations(f.vector, [n = f.mean_numerator, d = f.mean_denominator](const FrameView& view) {
    return view.interpolate_frame(*n, *d);
  });
  return std::make_shared<const Moment>(std::move(m));
}

MomentPtr two_pass_profile(const Fluctuating& f, std::array<bool, 3> homogeneous) {
  std::string axes;
  for (std::size_t a = 0; a < 3; ++a)
    if (homogeneous[a]) axes += "xyz"[a];
  Moment m = deviation_moment(f, "two_pass_profile over " + axes);
  m.values = deviations(f.vector, [n = f.mean_numerator, d = f.mean_denominator, homogeneous](const FrameView& view) {
    return view.interpolate_frame_profile(*n, *d, homogeneous);
  });
  return std::make_shared<const Moment>(std::move(m));
}

/// Σ V |q|² W, Σ V q W and Σ V W, in channels 0, 1 … 3 and 4. The volumes are summed along because all five must carry
/// the same rounding for their difference to mean anything.
MomentPtr second_moment(const Fluctuating& f) {
  Moment m;
  m.name = "volume " + f.label + " squared";
  m.channels = 5;
  m.in_double = true;
  m.columns = Column::radius | f.column;
  m.values = [vector = f.vector](const FrameView& view, std::span<double> q) {
    const Particles& p = view.particles();
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double volume = sphere_volume(p.radius[i]);
      q[5 * i] = volume * square_distance(p.*vector, i, {0, 0, 0});
      for (std::size_t a = 0; a < 3; ++a) q[5 * i + 1 + a] = volume * (p.*vector)[a][i];
      q[5 * i + 4] = volume;
    }
  };
  return std::make_shared<const Moment>(std::move(m));
}

/// Σ V q·q W - |Σ V q W|²/Σ V W. Rounding can leave a sum of squares a hair below zero: it is zero then.
MomentPtr one_pass(const Fluctuating& f) {
  Moment m;
  m.name = "volume " + f.label + " fluctuation one_pass";
  m.kind = Moment::Kind::voxels;
  m.frame_needs = {second_moment(f)};
  m.voxels = [](std::span<const double* const> in, std::span<double* const> out) {
    const double* volume = in[4];
    for (int v = 0; v < leaf_size; ++v) {
      if (!(volume[v] > 0)) continue;
      const double squared_mean = (in[1][v] * in[1][v] + in[2][v] * in[2][v] + in[3][v] * in[3][v]) / volume[v];
      out[0][v] = std::max(0.0, in[0][v] - squared_mean);
    }
  };
  return std::make_shared<const Moment>(std::move(m));
}

}  // namespace

MomentPtr fluctuation_moment(const Fluctuating& f, const std::string& mode, std::array<bool, 3> homogeneous) {
  if (mode == "two_pass") return two_pass(f);
  if (mode == "two_pass_profile") return two_pass_profile(f, homogeneous);
  return one_pass(f);
}

OptionInfo homogeneous_option() {
  return {.name = "homogeneous",
          .default_value = std::vector<std::string>{"x", "y"},
          .help = "axes along which the flow does not vary; two_pass_profile averages the mean over them first",
          .choices = {"x", "y", "z"}};
}

std::array<bool, 3> homogeneous_axes(const StageSettings& settings, const std::string& stage) {
  std::array<bool, 3> axes{};
  for (const std::string& name : option<std::vector<std::string>>(settings, stage, "homogeneous"))
    axes[static_cast<std::size_t>(name[0] - 'x')] = true;
  return axes;
}

}  // namespace grainvdb
