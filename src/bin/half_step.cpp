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

/// What meets at a contact: m* and, which DampingLaw::rate does without, R* and the overlap.
struct Meeting {
  double mass = 0, radius = 0, overlap = 0;
};

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
    const double distance = normalise(n);
    if (distance == 0) return;
    const double approach = along(i, n) - (image ? 0.0 : along(j, n));
    change_force(contacts.force, k, n, damping(meeting(i, j, distance)) * approach);
  }

  void correct_wall(std::size_t k) {
    WallContacts& contacts = frame_.wall_contacts;
    const std::size_t i = rows_.find(contacts.id[k]);
    if (i == ParticleRows::absent) return;  // wall_half_branches() says so
    Vec3 n;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      n[a] = frame_.box.minimum_image(axis, frame_.particles.position[a][i] - contacts.point[a][k]);
    }
    const double distance = normalise(n);
    if (distance > 0) change_force(contacts.force, k, n, damping(wall_meeting(i, distance)) * along(i, n));
  }

 private:
  // Returns the length that it had.
  static double normalise(Vec3& n) {
    const double length = std::sqrt(dot(n, n));
    if (length > 0)
      for (double& c : n) c /= length;
    return length;
  }

  // With half a step of the rate, along n, at which the force changes, and what follows of it.
  void change_force(Columns3& forces, std::size_t k, const Vec3& n, double rate) const {
    const double change = 0.5 * spec_.dt * rate;
    const Vec3 force{forces[0][k], forces[1][k], forces[2][k]};
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
    for (std::size_t a = 0; a < 3; ++a) forces[a][k] = (normal + change) * n[a] + stretch * tangential[a];
  }

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

  Meeting meeting(std::size_t i, std::size_t j, double distance) const {
    const std::vector<double>& r = frame_.particles.radius;
    if (spec_.law == DampingLaw::rate) return {effective_mass(i, j)};
    return {effective_mass(i, j), r[i] * r[j] / (r[i] + r[j]), std::max(0.0, r[i] + r[j] - distance)};
  }
  Meeting wall_meeting(std::size_t i, double distance) const {
    const std::vector<double>& r = frame_.particles.radius;
    if (spec_.law == DampingLaw::rate) return {frame_.particles.mass[i]};
    return {frame_.particles.mass[i], r[i], std::max(0.0, r[i] - distance)};
  }

  // γ.
  double damping(const Meeting& m) const {
    if (spec_.law == DampingLaw::rate) return spec_.rate * m.mass;
    if (spec_.law == DampingLaw::hooke) {
      const double q = 16.0 / 15.0 * std::sqrt(m.radius) * effective_modulus_;
      const double stiffness = q * std::pow(m.mass * square(spec_.characteristic_velocity) / q, 0.2);
      return 2 * damping_ratio_ * std::sqrt(stiffness * m.mass);
    }
    const double stiffness = 2 * effective_modulus_ * std::sqrt(m.radius * m.overlap);
    return 2 * std::sqrt(5.0 / 6.0) * damping_ratio_ * std::sqrt(stiffness * m.mass);
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
  parallel_ranges(frame.wall_contacts.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) correction.correct_wall(k);
  });
}

}  // namespace grainvdb
