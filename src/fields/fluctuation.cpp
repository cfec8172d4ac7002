#include "fields/fluctuation.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "fields/moments.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {
namespace {

std::string mode_of(const Fluctuating& f, const StageSettings& settings) {
  return option<std::string>(settings, f.stage, "mode");
}
bool one_pass(const std::string& mode) {
  return mode.starts_with("one_pass");
}
bool without_self_weight(const Fluctuating& f, const StageSettings& settings) {
  return option<std::string>(settings, f.stage, "self_weight") == "corrected";
}

std::array<bool, 3> homogeneous_axes(const Fluctuating& f, const StageSettings& settings) {
  std::array<bool, 3> axes{};
  for (const std::string& name : option<std::vector<std::string>>(settings, f.stage, "homogeneous"))
    axes[static_cast<std::size_t>(name[0] - 'x')] = true;
  return axes;
}

double square_distance(const Columns3& q, std::size_t i, const Vec3& mean) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) sum += (q[a][i] - mean[a]) * (q[a][i] - mean[a]);
  return sum;
}

Moment deviation_moment(const Fluctuating& f, const StageSettings& settings, const std::string& mode) {
  Moment m;
  m.name = "volume " + f.label + " fluctuation " + mode;
  m.columns = Column::radius | f.column;
  m.frame_needs = {f.mean_numerator(settings), f.mean_denominator(settings)};
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

MomentPtr two_pass_moment(const Fluctuating& f, const StageSettings& settings) {
  Moment m = deviation_moment(f, settings, "two_pass");
  m.values = deviations(f.vector, [n = m.frame_needs[0], d = m.frame_needs[1]](const FrameView& view) {
    return view.interpolate_frame(*n, *d);
  });
  return std::make_shared<const Moment>(std::move(m));
}

MomentPtr two_pass_profile_moment(const Fluctuating& f, const StageSettings& settings) {
  const std::array<bool, 3> homogeneous = homogeneous_axes(f, settings);
  std::string axes;
  for (std::size_t a = 0; a < 3; ++a)
    if (homogeneous[a]) axes += "xyz"[a];
  Moment m = deviation_moment(f, settings, "two_pass_profile over " + axes);
  m.whole_axes = homogeneous;
  m.values = deviations(f.vector, [n = m.frame_needs[0], d = m.frame_needs[1], homogeneous](const FrameView& view) {
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
MomentPtr one_pass_moment(const Fluctuating& f) {
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

/// Σ V W Σ_β (δ_αβ - w_αβ)²: what the deviations from the sampled mean keep of the variance.
MomentPtr two_pass_share(const Fluctuating& f, const StageSettings& settings) {
  Moment m;
  const MomentPtr total = f.mean_denominator(settings);
  m.name = "volume freedom about means by " + total->name;
  m.columns = ColumnSet(Column::radius) | total->columns;
  m.frame_needs = {total};
  m.values = [total](const FrameView& view, std::span<double> q) {
    const Particles& p = view.particles();
    const std::vector<double> factor = view.deviation_factors(*total);
    for (std::size_t i = 0; i < p.size(); ++i) q[i] = sphere_volume(p.radius[i]) * factor[i];
  };
  return std::make_shared<const Moment>(std::move(m));
}

/// Σ V² W², of which Σ w_β² = Σ V² W²/(Σ V W)².
MomentPtr volume_squares() {
  Moment m;
  m.name = "volume squares";
  m.kind = Moment::Kind::particle_squares;
  m.columns = Column::radius;
  m.values = [](const FrameView& view, std::span<double> q) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      const double volume = sphere_volume(view.particles().radius[i]);
      q[i] = volume * volume;
    }
  };
  return std::make_shared<const Moment>(std::move(m));
}

/// Σ V W (1 - Σ w_β²): what the deviations from the mean at the voxel keep of the variance.
MomentPtr one_pass_share(const Fluctuating& f) {
  Moment m;
  m.name = "volume " + f.label + " freedom one_pass";
  m.kind = Moment::Kind::voxels;
  m.frame_needs = {second_moment(f), volume_squares()};
  m.voxels = [](std::span<const double* const> in, std::span<double* const> out) {
    for (int v = 0; v < leaf_size; ++v)
      if (in[4][v] > 0) out[0][v] = std::max(0.0, in[4][v] - in[5][v] / in[4][v]);
  };
  return std::make_shared<const Moment>(std::move(m));
}

MomentPtr fluctuation_moment(const Fluctuating& f, const StageSettings& settings) {
  const std::string mode = mode_of(f, settings);
  if (one_pass(mode)) return one_pass_moment(f);
  return mode == "two_pass" ? two_pass_moment(f, settings) : two_pass_profile_moment(f, settings);
}

/// What the sum of squared deviations is divided by.
MomentPtr divisor_moment(const Fluctuating& f, const StageSettings& settings) {
  if (!without_self_weight(f, settings)) return volume_moment();
  return one_pass(mode_of(f, settings)) ? one_pass_share(f) : two_pass_share(f, settings);
}

/// Where less than this part of the variance is left, there is little but a particle in its own mean: dividing would
/// multiply rounding (6e-11 v² of the two-pass deviations) beyond what a float is good for.
constexpr double least_share = 1e-3;

void write_deviations(const Fluctuating& f, const StageInput& in, SparseField& out) {
  const MomentPtr above = fluctuation_moment(f, in.settings());
  const MomentPtr below = divisor_moment(f, in.settings());
  const MomentPtr all = volume_moment();
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    const double* squares = in.moment(leaf, *above, 0);
    const double* divisor = in.moment(leaf, *below, 0);
    const double* volume = in.moment(leaf, *all, 0);
    float* to = out.leaf(leaf);
    in.topology().mask(leaf).for_each([&](int v) {
      if (divisor[v] > least_share * volume[v]) {
        to[v] = static_cast<float>(squares[v] / divisor[v]);
      } else {
        to[v] = std::numeric_limits<float>::quiet_NaN();
        in.mask().add(leaf, v, volume[v] > 0 ? Reason::lone_particles : Reason::no_material);
      }
    });
  });
}

/// Takes (c²/12) L:L off the variance, the part that a linear flow u = L x has by itself (physics section 3).
void subtract_gradient_part(const Fluctuating& f, const StageInput& in, SparseField& out) {
  const SparseField& gradient = in.field(f.gradient);
  const MomentPtr below = divisor_moment(f, in.settings());
  const MomentPtr all = volume_moment();
  const double factor = in.kernel().cutoff() * in.kernel().cutoff() / 12;
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    const double* divisor = in.moment(leaf, *below, 0);
    const double* volume = in.moment(leaf, *all, 0);
    float* t = out.leaf(leaf);
    in.topology().mask(leaf).for_each([&](int v) {
      double squares = 0;
      for (int c = 0; c < 9; ++c) {
        const double l = gradient.leaf(leaf, c)[v];
        squares += l * l;
      }
      t[v] = static_cast<float>(t[v] - factor * squares * (volume[v] / divisor[v]));
      if (t[v] < 0) {
        t[v] = std::numeric_limits<float>::quiet_NaN();
        in.mask().add(leaf, v, Reason::negative_temperature);
      }
    });
  });
}

std::vector<OptionInfo> options_of(const Fluctuating& f) {
  return {{.name = "mode",
           .default_value = std::string("two_pass"),
           .help = "two_pass: about the frame's mean at the particle (A15); two_pass_profile: about the mean over the "
                   "homogeneous axes; one_pass: second moments about the mean at the voxel; one_pass_corrected: less "
                   "(c^2/12) L:L, L the " +
                   f.gradient,
           .choices = {"two_pass", "two_pass_profile", "one_pass", "one_pass_corrected"}},
          {.name = "self_weight",
           .default_value = std::string("none"),
           .help = "corrected: divides by what a mean that contains each particle leaves of the variance (11 % less "
                   "at c = 3d for two_pass); not for two_pass_profile, whose means have many particles",
           .choices = {"none", "corrected"}},
          {.name = "homogeneous",
           .default_value = std::vector<std::string>{"x", "y"},
           .help = "axes along which the flow does not vary; two_pass_profile averages the mean over them first",
           .choices = {"x", "y", "z"}}};
}

}  // namespace

void set_fluctuation(Stage& stage, const Fluctuating& f) {
  stage.options = options_of(f);
  stage.conflict = [f](const StageSettings& settings) -> std::optional<OptionConflict> {
    if (!without_self_weight(f, settings) || mode_of(f, settings) != "two_pass_profile") return std::nullopt;
    return OptionConflict{"self_weight", "'corrected' with mode 'two_pass_profile'",
                          "'none': means over whole planes hardly follow one particle"};
  };
  stage.species_conflict = [f](const StageSettings& settings) -> std::optional<OptionConflict> {
    if (!one_pass(mode_of(f, settings))) return std::nullopt;
    return OptionConflict{"mode", "'" + mode_of(f, settings) + "' for one species",
                          "'two_pass' or 'two_pass_profile': about the mean of all grains"};
  };
  stage.needs = [f](const StageSettings& settings) {
    StageNeeds needs{{}, {fluctuation_moment(f, settings), volume_moment()}};
    if (without_self_weight(f, settings)) needs.moments.push_back(divisor_moment(f, settings));
    if (mode_of(f, settings) == "one_pass_corrected") needs.fields.push_back(f.gradient);
    return needs;
  };
  stage.compute = [f](const StageInput& in, SparseField& out) {
    write_deviations(f, in, out);
    if (mode_of(f, in.settings()) == "one_pass_corrected") subtract_gradient_part(f, in, out);
  };
}

}  // namespace grainvdb
