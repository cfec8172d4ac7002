#include "bin/half_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "base/parallel.hpp"
#include "base/vec3.hpp"
#include "bin/particle_rows.hpp"

namespace grainvdb {
namespace {

// Dumps have six digits: a contact slides where its tangential force is this near to the friction limit.
constexpr double sliding = 0.9999;

double square(double x) {
  return x * x;
}

class Correction {
 public:
  Correction(const HalfStep& spec, Frame& frame)
      : spec_(spec), frame_(frame), rows_(frame.particles.id), has_image_(frame.box.periodic) {
    const double log_e = std::log(spec.restitution > 0 ? spec.restitution : 1.0);
    damping_ratio_ = -log_e / std::sqrt(square(log_e) + square(std::numbers::pi));
    effective_modulus_ = spec.youngs_modulus / (2 * (1 - square(spec.poisson_ratio)));
  }

  void correct(std::size_t k) {
    Contacts& contacts = frame_.contacts;
    const std::size_t i = rows_.find(contacts.id1[k]);
    const std::size_t j = rows_.find(contacts.id2[k]);
    if (i == ParticleRows::absent || j == ParticleRows::absent) return;  // half_branches() says so
    Vec3 n;
    bool image = false;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const Columns3& x = frame_.particles.position;
      n[a] = frame_.box.minimum_image(axis, x[a][i] - x[a][j]);
      const double apart = place(axis, x[a][i]) - place(axis, x[a][j]);
      image |= has_image_[a] && std::abs(apart - n[a]) > 0.5 * frame_.box.length(axis);
    }
    const double distance = std::sqrt(dot(n, n));
    if (distance == 0) return;
    for (double& c : n) c /= distance;

    const double approach = along(i, n) - (image ? 0.0 : along(j, n));
    const double change = 0.5 * damping(i, j, distance) * spec_.dt * approach;
    Vec3 force{contacts.force[0][k], contacts.force[1][k], contacts.force[2][k]};
    const double normal = dot(force, n);
    Vec3 tangential;
    for (std::size_t a = 0; a < 3; ++a) tangential[a] = force[a] - normal * n[a];
    double stretch = 1;
    if (spec_.friction) {
      const double magnitude = std::sqrt(dot(tangential, tangential));
      const double limit = *spec_.friction * std::abs(normal);
      if (magnitude > 0 && magnitude >= sliding * limit)
        stretch += *spec_.friction * (std::abs(normal + change) - std::abs(normal)) / magnitude;
    }
    for (std::size_t a = 0; a < 3; ++a) contacts.force[a][k] = (normal + change) * n[a] + stretch * tangential[a];
  }

 private:
  // Between the steps at which it sorts them, a run lets particles leave the box a little without wrapping them; only
  // unwrapped coordinates lie farther out.
  double place(int axis, double x) const {
    const auto a = static_cast<std::size_t>(axis);
    const double margin = 0.5 * frame_.box.length(axis);
    const bool is_near = x >= frame_.box.lo[a] - margin && x < frame_.box.hi[a] + margin;
    return is_near ? x : frame_.box.wrap(axis, x);
  }

  bool is_of(const std::vector<int>& types, std::size_t particle) const {
    return !types.empty() && std::ranges::find(types, frame_.particles.type[particle]) != types.end();
  }
  bool frozen(std::size_t particle) const { return is_of(spec_.frozen_types, particle); }

  // f·n/m.
  double along(std::size_t particle, const Vec3& n) const {
    if (frozen(particle) || is_of(spec_.still_types, particle)) return 0;
    const Columns3& f = frame_.particles.force;
    return (f[0][particle] * n[0] + f[1][particle] * n[1] + f[2][particle] * n[2]) / frame_.particles.mass[particle];
  }

  double effective_mass(std::size_t i, std::size_t j) const {
    const std::vector<double>& m = frame_.particles.mass;
    if (frozen(i)) return m[j];
    if (frozen(j)) return m[i];
    return m[i] * m[j] / (m[i] + m[j]);
  }

  // γ.
  double damping(std::size_t i, std::size_t j, double distance) const {
    const double mass = effective_mass(i, j);
    if (spec_.law == DampingLaw::rate) return spec_.rate * mass;
    const std::vector<double>& r = frame_.particles.radius;
    const double radius = r[i] * r[j] / (r[i] + r[j]);
    if (spec_.law == DampingLaw::hooke) {
      const double q = 16.0 / 15.0 * std::sqrt(radius) * effective_modulus_;
      const double stiffness = q * std::pow(mass * square(spec_.characteristic_velocity) / q, 0.2);
      return 2 * damping_ratio_ * std::sqrt(stiffness * mass);
    }
    const double overlap = std::max(0.0, r[i] + r[j] - distance);
    const double stiffness = 2 * effective_modulus_ * std::sqrt(radius * overlap);
    return 2 * std::sqrt(5.0 / 6.0) * damping_ratio_ * std::sqrt(stiffness * mass);
  }

  const HalfStep& spec_;
  Frame& frame_;
  ParticleRows rows_;
  std::array<bool, 3> has_image_;
  double damping_ratio_ = 0;
  double effective_modulus_ = 0;
};

}  // namespace

ColumnSet half_step_columns(const HalfStep& spec) {
  ColumnSet columns = Column::force | Column::mass;
  if (spec.law != DampingLaw::rate) columns |= Column::radius;
  if (!spec.still_types.empty() || !spec.frozen_types.empty()) columns |= Column::type;
  return columns;
}

void correct_half_step(const HalfStep& spec, Frame& frame) {
  if (std::ranges::find(spec.whole_steps, frame.step) != spec.whole_steps.end()) return;
  Correction correction(spec, frame);
  parallel_ranges(frame.contacts.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) correction.correct(k);
  });
}

}  // namespace grainvdb
