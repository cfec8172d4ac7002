#include "fields/moments.hpp"

#include <cstddef>

namespace grainvdb {
namespace {

bool mass_weighted(const StageSettings& settings) {
  return option<std::string>(settings, "velocity", "weighting") == "mass";
}

enum class Weight { volume, mass };

double weight_of(const Particles& p, std::size_t i, Weight w) {
  return w == Weight::mass ? p.mass[i] : sphere_volume(p.radius[i]);
}

ColumnSet columns_of(Weight w) {
  return w == Weight::mass ? Column::mass : Column::radius;
}
const char* name_of(Weight w) {
  return w == Weight::mass ? "mass" : "volume";
}

Moment weight_moment(Weight w) {
  Moment m;
  m.name = name_of(w);
  m.columns = columns_of(w);
  m.values = [w](const FrameView& view, std::span<double> q) {
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = weight_of(view.particles(), i, w);
  };
  return m;
}

/// Σ w q W for a vector column q of the particles.
Moment vector_moment(Weight w, Column column, const char* label, Columns3 Particles::*member) {
  Moment m;
  m.weight = std::make_shared<const Moment>(weight_moment(w));
  m.name = std::string(name_of(w)) + " " + label;
  m.channels = 3;
  m.columns = columns_of(w) | column;
  m.values = [w, member](const FrameView& view, std::span<double> q) {
    const Particles& p = view.particles();
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double weight = weight_of(p, i, w);
      for (std::size_t a = 0; a < 3; ++a) q[3 * i + a] = weight * (p.*member)[a][i];
    }
  };
  return m;
}

/// The same sum with ∂_j W for W.
MomentPtr gradient_of(Moment m) {
  m.name += " gradient";
  m.weight.reset();
  m.kind = Moment::Kind::particle_gradients;
  m.channels *= 3;
  return std::make_shared<const Moment>(std::move(m));
}

Weight velocity_weight(const StageSettings& s) {
  return mass_weighted(s) ? Weight::mass : Weight::volume;
}

Moment velocity_sum(const StageSettings& s) {
  return vector_moment(velocity_weight(s), Column::velocity, "velocity", &Particles::velocity);
}

Moment spin_sum() {
  return vector_moment(Weight::volume, Column::angular_velocity, "angular velocity", &Particles::angular_velocity);
}

}  // namespace

MomentPtr volume_moment() {
  return std::make_shared<const Moment>(weight_moment(Weight::volume));
}
MomentPtr mass_moment() {
  return std::make_shared<const Moment>(weight_moment(Weight::mass));
}

MomentPtr volume_diameter_moment() {
  Moment m;
  m.name = "volume diameter";
  m.columns = Column::radius;
  m.values = [](const FrameView& view, std::span<double> q) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      const double r = view.particles().radius[i];
      q[i] = sphere_volume(r) * 2 * r;
    }
  };
  return std::make_shared<const Moment>(std::move(m));
}

MomentPtr volume_spin_moment() {
  return std::make_shared<const Moment>(spin_sum());
}
MomentPtr volume_spin_gradient() {
  return gradient_of(spin_sum());
}
MomentPtr volume_gradient() {
  return gradient_of(weight_moment(Weight::volume));
}

MomentPtr velocity_numerator(const StageSettings& s) {
  return std::make_shared<const Moment>(velocity_sum(s));
}
MomentPtr velocity_denominator(const StageSettings& s) {
  return std::make_shared<const Moment>(weight_moment(velocity_weight(s)));
}
MomentPtr velocity_numerator_gradient(const StageSettings& s) {
  return gradient_of(velocity_sum(s));
}
MomentPtr velocity_denominator_gradient(const StageSettings& s) {
  return gradient_of(weight_moment(velocity_weight(s)));
}

}  // namespace grainvdb
