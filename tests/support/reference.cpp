#include "support/reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace grainvdb::testing {
namespace {

/// Error of a velocity that was averaged and interpolated, relative to the velocities' magnitude: numerator and
/// denominator both carry the error of their sums.
constexpr double velocity_rounding = 2 * sum_rounding;

/// Error of what is left of the variance (held to 1e-5 by its own tests), relative to Σ V W.
constexpr double share_rounding = 1e-5;
/// No fluctuation is defined below this share.
constexpr double least_share = 1e-3;

std::string text_option(const Pipeline& p, const std::string& stage, const std::string& name) {
  return option<std::string>(p.stages, stage, name);
}

std::array<bool, 3> axes_option(const Pipeline& p, const std::string& stage) {
  std::array<bool, 3> axes{};
  for (const std::string& name : option<std::vector<std::string>>(p.stages, stage, "homogeneous"))
    axes[name == "x" ? 0 : name == "y" ? 1 : 2] = true;
  return axes;
}

double volume(const Particles& p, std::size_t i) {
  return 4.0 / 3.0 * std::numbers::pi * p.radius[i] * p.radius[i] * p.radius[i];
}

/// q laid out [particle][channel] from f(particle, channel).
template <class F>
std::vector<double> per_particle(const Particles& p, int channels, const F& f) {
  std::vector<double> q;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (int c = 0; c < channels; ++c) q.push_back(f(i, static_cast<std::size_t>(c)));
  return q;
}

/// All sums of one frame, or their sum over frames.
struct Moments {
  Sums volume, mass, weight, momentum, diameter, spin, fluctuation, spin_fluctuation, kinetic, contact,
      momentum_gradient, weight_gradient, spin_gradient, volume_gradient, share, spin_share;

  Moments& operator+=(const Moments& o) {
    for (auto member : {&Moments::volume, &Moments::mass, &Moments::weight, &Moments::momentum, &Moments::diameter,
                        &Moments::spin, &Moments::fluctuation, &Moments::spin_fluctuation, &Moments::kinetic,
                        &Moments::contact, &Moments::momentum_gradient, &Moments::weight_gradient,
                        &Moments::spin_gradient, &Moments::volume_gradient, &Moments::share, &Moments::spin_share})
      this->*member += o.*member;
    return *this;
  }
};

class Grainer {
 public:
  Grainer(const VoxelBox& box, const Pipeline& pipeline) : box_(box), pipeline_(pipeline) {}

  /// The moments of a frame; the kinetic stress is added by `kinetic` once the reference velocity is known.
  Moments moments(const Frame& frame) const {
    const Particles p = material(frame, pipeline_.select);
    const bool by_mass = text_option(pipeline_, "velocity", "weighting") == "mass";
    const auto w = [&](std::size_t i) { return by_mass ? p.mass[i] : volume(p, i); };
    const auto particles = [&](int channels, const auto& f) {
      return particle_sums(box_, pipeline_.cutoff, p, per_particle(p, channels, f), channels);
    };
    const Sums v = particles(1, [&](std::size_t i, std::size_t) { return volume(p, i); });
    const Sums weight = particles(1, [&](std::size_t i, std::size_t) { return w(i); });
    const auto momentum_of = [&](std::size_t i, std::size_t a) { return w(i) * p.velocity[a][i]; };
    const auto spin_of = [&](std::size_t i, std::size_t a) { return volume(p, i) * p.angular_velocity[a][i]; };
    const Sums momentum = particles(3, momentum_of);
    const Sums spin = particles(3, spin_of);
    Moments m{v,
              particles(1, [&](std::size_t i, std::size_t) { return p.mass[i]; }),
              weight,
              momentum,
              particles(1, [&](std::size_t i, std::size_t) { return volume(p, i) * 2 * p.radius[i]; }),
              spin,
              fluctuation(p, p.velocity, "temperature", momentum, weight, v),
              fluctuation(p, p.angular_velocity, "rotational_fluctuation", spin, v, v),
              Sums(box_.size(), 18),
              contact(frame),
              gradient_sums(box_, pipeline_.cutoff, p, per_particle(p, 3, momentum_of), 3),
              gradient_sums(box_, pipeline_.cutoff, p,
                            per_particle(p, 1, [&](std::size_t i, std::size_t) { return w(i); }), 1),
              gradient_sums(box_, pipeline_.cutoff, p, per_particle(p, 3, spin_of), 3),
              gradient_sums(box_, pipeline_.cutoff, p,
                            per_particle(p, 1, [&](std::size_t i, std::size_t) { return volume(p, i); }), 1),
              share(p, "temperature", w, weight, v),
              share(
                  p, "rotational_fluctuation", [&](std::size_t i) { return volume(p, i); }, v, v)};
    return m;
  }

  /// -Σ m u'_i u'_j W in channels 0 … 8, its rounding in 9 … 17.
  Sums kinetic(const Frame& frame, const Sums& momentum, const Sums& weight) const {
    const Particles p = material(frame, pipeline_.select);
    const std::vector<Vec3> u = interpolate(box_, momentum, weight, p.position);
    return particle_sums(box_, pipeline_.cutoff, p,
                         per_particle(p, 18,
                                      [&](std::size_t n, std::size_t c) {
                                        const std::size_t i = c % 9 / 3;
                                        const std::size_t j = c % 3;
                                        const double di = p.velocity[i][n] - u[n][i];
                                        const double dj = p.velocity[j][n] - u[n][j];
                                        if (c < 9) return -p.mass[n] * di * dj;
                                        const double ei = velocity_rounding * size(p.velocity, n, u[n]);
                                        return p.mass[n] * (std::abs(di) * ei + std::abs(dj) * ei + ei * ei);
                                      }),
                         18);
  }

 private:
  static double size(const Columns3& q, std::size_t i, const Vec3& mean) {
    double s = 0;
    for (std::size_t a = 0; a < 3; ++a) s += std::abs(q[a][i]) + std::abs(mean[a]);
    return s;
  }

  /// Σ V |q - q̃|² W in channel 0, its rounding in channel 1.
  Sums fluctuation(const Particles& p, const Columns3& q, const std::string& stage, const Sums& numerator,
                   const Sums& denominator, const Sums& volumes) const {
    const std::string mode = text_option(pipeline_, stage, "mode");
    if (mode.starts_with("one_pass")) return about_voxel_mean(p, q, volumes);
    const std::vector<Vec3> mean = mode == "two_pass" ? interpolate(box_, numerator, denominator, p.position)
                                                      : interpolate_profile(box_, numerator, denominator, p.position,
                                                                            axes_option(pipeline_, stage));
    return particle_sums(box_, pipeline_.cutoff, p,
                         per_particle(p, 2,
                                      [&](std::size_t i, std::size_t c) {
                                        double square = 0;
                                        for (std::size_t a = 0; a < 3; ++a) square += std::pow(q[a][i] - mean[i][a], 2);
                                        if (c == 0) return volume(p, i) * square;
                                        const double e = velocity_rounding * size(q, i, mean[i]);
                                        return volume(p, i) * (2 * std::sqrt(3 * square) * e + e * e);
                                      }),
                         2);
  }

  /// Σ V W times what the deviations keep of a variance; Σ V W itself where self-weight is left in.
  template <class Weight>
  Sums share(const Particles& p, const std::string& stage, const Weight& weight, const Sums& denominator,
             const Sums& volumes) const {
    if (text_option(pipeline_, stage, "self_weight") == "none") return volumes;
    const auto per = [&](const auto& f) {
      return per_particle(p, 1, [&](std::size_t i, std::size_t) { return f(i); });
    };
    if (!text_option(pipeline_, stage, "mode").starts_with("one_pass")) {
      const std::vector<double> factor =
          deviation_factors(box_, pipeline_.cutoff, per(weight), denominator, p.position);
      return particle_sums(box_, pipeline_.cutoff, p, per([&](std::size_t i) { return volume(p, i) * factor[i]; }), 1);
    }
    Sums result = volumes;
    const Sums squares =
        square_sums(box_, pipeline_.cutoff, p, per([&](std::size_t i) { return std::pow(volume(p, i), 2); }), 1);
    for (std::size_t n = 0; n < box_.size(); ++n)
      if (volumes.at(n) > 0) result.at(n) = std::max(0.0, volumes.at(n) - squares.at(n) / volumes.at(n));
    return result;
  }

  /// The same about the volume-weighted mean at the voxel. The magnitude is that of the second moments whose
  /// difference this is: Σ V q·q W + |Σ V q W|²/Σ V W.
  Sums about_voxel_mean(const Particles& p, const Columns3& q, const Sums& volumes) const {
    const Sums first =
        particle_sums(box_, pipeline_.cutoff, p,
                      per_particle(p, 3, [&](std::size_t i, std::size_t a) { return volume(p, i) * q[a][i]; }), 3);
    const Sums second =
        particle_sums(box_, pipeline_.cutoff, p,
                      per_particle(p, 1,
                                   [&](std::size_t i, std::size_t) {
                                     return volume(p, i) * (q[0][i] * q[0][i] + q[1][i] * q[1][i] + q[2][i] * q[2][i]);
                                   }),
                      1);
    Sums result(box_.size(), 2);
    result.reached = volumes.reached;
    for (std::size_t n = 0; n < box_.size(); ++n) {
      if (volumes.at(n) <= 0) continue;
      double square = 0;
      for (int a = 0; a < 3; ++a) square += first.at(n, a) * first.at(n, a) / volumes.at(n);
      result.at(n, 0) = std::max(0.0, second.at(n) - square);
      result.magnitude[result.index(n, 0)] = second.at(n) + square;
    }
    return result;
  }

  Sums contact(const Frame& frame) const {
    const Branches b = branches_of(frame);
    std::vector<double> q;
    for (std::size_t k = 0; k < b.size(); ++k)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) q.push_back(-b.force[k][i] * b.arm[k][j]);
    const std::string method = text_option(pipeline_, "contact_stress", "line_integral");
    if (method == "adaptive") throw std::logic_error("the reference knows the integral itself, not the adaptive rule");
    return branch_sums(box_, pipeline_.cutoff, b, q, 9, method == "exact" ? 0 : method.back() - '0');
  }

  const VoxelBox& box_;
  const Pipeline& pipeline_;
};

/// Channels first … first+components-1 over the frames' mean; `floor_channel` holds their rounding, if any does.
ReferenceField mean_of(const Sums& sums, int components, double frames, std::optional<int> floor_channel = {}) {
  ReferenceField f;
  f.components = components;
  for (std::size_t n = 0; n < sums.reached.size(); ++n)
    for (int c = 0; c < components; ++c) {
      f.value.push_back(sums.at(n, c) / frames);
      f.magnitude.push_back(sums.size(n, c) / frames);
      f.floor.push_back(floor_channel ? sums.at(n, *floor_channel + c) / frames : 0);
    }
  return f;
}

ReferenceField ratio_of(const Sums& above, int components, const Sums& below, std::optional<int> floor_channel = {}) {
  ReferenceField f = mean_of(above, components, 1, floor_channel);
  for (std::size_t n = 0; n < below.reached.size(); ++n)
    for (int c = 0; c < components; ++c) {
      const double w = below.at(n);
      const std::size_t at = f.index(n, c);
      f.value[at] = w > 0 ? f.value[at] / w : std::numeric_limits<double>::quiet_NaN();
      f.magnitude[at] /= w;
      f.floor[at] /= w;
    }
  return f;
}

/// A ratio by what is left of the variance, undefined where that is next to nothing. The shares carry errors of
/// 1e-5 Σ V W.
ReferenceField fluctuation_of(const Sums& squares, const Sums& share, const Sums& volume) {
  ReferenceField f = ratio_of(squares, 1, share, 1);
  for (std::size_t n = 0; n < volume.reached.size(); ++n) {
    if (!(share.at(n) > least_share * volume.at(n))) f.value[n] = std::numeric_limits<double>::quiet_NaN();
    if (share.at(n) != volume.at(n)) f.floor[n] += share_rounding * volume.at(n) / share.at(n) * f.value[n];
  }
  return f;
}

/// What is left of the variance.
ReferenceField share_of(const Sums& share, const Sums& volume) {
  ReferenceField f = ratio_of(share, 1, volume);
  for (double& x : f.floor) x = share_rounding;
  return f;
}

/// The quotient rule on u = Σ w v W/Σ w W.
ReferenceField gradient_by_kernel(const Sums& above, const Sums& below, const Sums& above_gradient,
                                  const Sums& below_gradient) {
  ReferenceField f;
  f.components = 9;
  for (std::size_t n = 0; n < below.reached.size(); ++n)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double w = below.at(n);
        const double u = above.at(n, i) / w;
        const double value = (above_gradient.at(n, 3 * i + j) - u * below_gradient.at(n, j)) / w;
        f.value.push_back(w > 0 ? value : std::numeric_limits<double>::quiet_NaN());
        f.magnitude.push_back((above_gradient.size(n, 3 * i + j) + above.size(n, i) / w * below_gradient.size(n, j)) /
                              w);
        f.floor.push_back(0);
      }
  return f;
}

bool inside(const std::pair<Vec3, Vec3>& region, const Box& box, const Particles& p, std::size_t i) {
  for (std::size_t a = 0; a < 3; ++a) {
    double x = p.position[a][i];
    const double l = box.hi[a] - box.lo[a];
    if (box.periodic[a]) x -= l * std::floor((x - box.lo[a]) / l);
    if (x < region.first[a] || x >= region.second[a]) return false;
  }
  return true;
}

double largest_radius(const std::vector<Frame>& frames) {
  double r = 0;
  for (const Frame& f : frames)
    r = std::max(r, *std::max_element(f.particles.radius.begin(), f.particles.radius.end()));
  return r;
}

}  // namespace

Uncertain ReferenceField::expected(std::size_t voxel, int component) const {
  const std::size_t at = index(voxel, component);
  if (std::isnan(value[at])) return undefined_value();
  return stored({value[at], rounding * magnitude[at] + floor[at]});
}

Particles material(const Frame& frame, const Selection& selection) {
  const Particles& p = frame.particles;
  Particles kept;
  const auto keep = [&](auto& to, const auto& from, std::size_t i) { to.push_back(from[i]); };
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!selection.types.empty() && std::count(selection.types.begin(), selection.types.end(), p.type[i]) == 0)
      continue;
    if (selection.ids && (p.id[i] < selection.ids->first || p.id[i] > selection.ids->second)) continue;
    if (selection.region && !inside(*selection.region, frame.box, p, i)) continue;
    keep(kept.id, p.id, i);
    keep(kept.type, p.type, i);
    keep(kept.radius, p.radius, i);
    keep(kept.mass, p.mass, i);
    for (std::size_t a = 0; a < 3; ++a) {
      keep(kept.position[a], p.position[a], i);
      keep(kept.velocity[a], p.velocity[a], i);
      keep(kept.angular_velocity[a], p.angular_velocity[a], i);
    }
  }
  return kept;
}

Reference coarse_grain(const std::vector<Frame>& frames, const Pipeline& pipeline) {
  Reference result{
      VoxelBox(frames, pipeline.voxel, pipeline.origin, pipeline.cutoff + 2 * largest_radius(frames)), {}, {}, {}};
  const Grainer grainer(result.box, pipeline);
  std::vector<Moments> parts;
  for (const Frame& f : frames) parts.push_back(grainer.moments(f));
  Moments total = parts.front();
  for (std::size_t k = 1; k < parts.size(); ++k) total += parts[k];

  const bool time_mean = text_option(pipeline, "kinetic_stress", "reference") == "time_mean";
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Moments& about = time_mean ? total : parts[k];
    total.kinetic += grainer.kinetic(frames[k], about.momentum, about.weight);
  }

  result.particle_frames = total.volume.reached;
  result.any_frames.assign(result.box.size(), 0);
  for (const Moments& m : parts)
    for (std::size_t n = 0; n < result.box.size(); ++n)
      result.any_frames[n] += m.volume.reached[n] + m.contact.reached[n] > 0 ? 1 : 0;

  const auto count = static_cast<double>(frames.size());
  auto& fields = result.fields;
  fields["phi"] = mean_of(total.volume, 1, count);
  fields["density"] = mean_of(total.mass, 1, count);
  fields["velocity"] = ratio_of(total.momentum, 3, total.weight);
  fields["mean_diameter"] = ratio_of(total.diameter, 1, total.volume);
  fields["angular_velocity"] = ratio_of(total.spin, 3, total.volume);
  fields["temperature"] = fluctuation_of(total.fluctuation, total.share, total.volume);
  fields["temperature_share"] = share_of(total.share, total.volume);
  fields["rotational_fluctuation"] = fluctuation_of(total.spin_fluctuation, total.spin_share, total.volume);
  fields["rotational_fluctuation_share"] = share_of(total.spin_share, total.volume);
  fields["contact_stress"] = mean_of(total.contact, 9, count);
  fields["contact_stress"].rounding =
      text_option(pipeline, "contact_stress", "line_integral") == "exact" ? contact_sum_rounding : gauss_sum_rounding;
  fields["kinetic_stress"] = mean_of(total.kinetic, 9, count, 9);
  fields["gradient_by_kernel"] =
      gradient_by_kernel(total.momentum, total.weight, total.momentum_gradient, total.weight_gradient);
  fields["spin_gradient_by_kernel"] =
      gradient_by_kernel(total.spin, total.volume, total.spin_gradient, total.volume_gradient);
  return result;
}

}  // namespace grainvdb::testing
