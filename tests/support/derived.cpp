#include "support/derived.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "support/principal.hpp"

namespace grainvdb::testing {
namespace {

double number_option(const Pipeline& p, const std::string& stage, const std::string& name) {
  return option<double>(p.stages, stage, name);
}

/// One voxel: its inputs, its results and its reasons.
class Voxel {
 public:
  Voxel(const UncertainFields& in, Derived& out, std::size_t n) : in_(in), out_(out), n_(n) {}

  Uncertain get(const std::string& name, int component = 0) const {
    const auto it = out_.fields.find(name);
    return (it != out_.fields.end() ? it->second : in_.at(name)).at(n_, component);
  }
  UncertainTensor tensor(const std::string& name) const {
    UncertainTensor t;
    for (int c = 0; c < 9; ++c) t[static_cast<std::size_t>(c)] = get(name, c);
    return t;
  }
  void put(const std::string& name, int component, const Uncertain& value) {
    UncertainField& f = out_.fields.at(name);
    f.values[n_ * static_cast<std::size_t>(f.components) + static_cast<std::size_t>(component)] =
        is_in_doubt(value) || value.undefined() ? value : stored(value);
  }
  /// Notes the reason where `missing` holds.
  void note(Reason reason, const Verdict& missing) {
    const auto bit = static_cast<std::uint32_t>(reason);
    if (!missing.sure) {
      out_.unsure[n_] |= bit;
    } else if (missing.yes) {
      out_.mask[n_] |= bit;
    }
  }

 private:
  const UncertainFields& in_;
  Derived& out_;
  std::size_t n_;
};

Verdict fails(const Verdict& v) {
  return {!v.yes, v.sure};
}

/// The value, NaN or in doubt, depending on the conditions under which it is undefined.
Uncertain unless(std::initializer_list<Verdict> missing, const Uncertain& value) {
  bool doubt = false;
  for (const Verdict& m : missing) {
    if (m.sure && m.yes) return undefined_value();
    doubt = doubt || !m.sure;
  }
  return doubt ? in_doubt() : value;
}

Uncertain trace_third(const UncertainTensor& t) {
  return (t[0] + t[4] + t[8]) / 3;
}

/// Σ (t_ij - δ_ij Tr t/3)²
Uncertain deviator_square(const UncertainTensor& t) {
  const Uncertain mean = trace_third(t);
  Uncertain sum;
  for (std::size_t c = 0; c < 9; ++c) {
    const Uncertain d = c % 4 == 0 ? t[c] - mean : t[c];
    sum = sum + d * d;
  }
  return sum;
}

UncertainTensor symmetric(const UncertainTensor& t) {
  UncertainTensor s;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) s[3 * i + j] = 0.5 * (t[3 * i + j] + t[3 * j + i]);
  return s;
}

/// The sense of an axis in which its first component beyond ½ in magnitude is positive; in doubt where one that decides
/// this is as near to ½ as its error.
std::array<Uncertain, 3> signed_axis(const Vec3& axis, double error) {
  double sign = 1;
  for (double x : axis) {
    if (std::abs(std::abs(x) - 0.5) <= error) return {in_doubt(), in_doubt(), in_doubt()};
    if (std::abs(x) < 0.5) continue;
    sign = x > 0 ? 1 : -1;
    break;
  }
  return {Uncertain{sign * axis[0], error}, Uncertain{sign * axis[1], error}, Uncertain{sign * axis[2], error}};
}

/// Any of the inputs is NaN for certain, or perhaps.
template <class... U>
Verdict any_undefined(const U&... inputs) {
  if ((inputs.undefined() || ...)) return {true, true};
  return {false, !(is_in_doubt(inputs) || ...)};
}

/// What the rounding of a mean vector can make of squared fluctuations.
Uncertain noise_square(const Voxel& v, const Pipeline& p, const std::string& name) {
  const double resolution = number_option(p, name, "resolution");
  Uncertain sum;
  for (int a = 0; a < 3; ++a) sum = sum + v.get(name, a) * v.get(name, a);
  return resolution * resolution * sum;
}

/// a > threshold and a ≥ rounding.
Verdict fluctuates(const Uncertain& a, double threshold, const Uncertain& rounding) {
  const Verdict above = exceeds(a, threshold);
  const Uncertain gap = a - rounding;
  const Verdict clear{gap.value >= 0, std::abs(gap.value) > gap.error || gap.error == 0};
  if ((above.sure && !above.yes) || (clear.sure && !clear.yes)) return {false, true};
  return {above.yes && clear.yes, above.sure && clear.sure};
}

void stress_fields(Voxel& v, const Pipeline& p) {
  const UncertainTensor s = v.tensor("stress");
  v.put("pressure", 0, -1.0 * trace_third(s));
  v.put("shear_stress", 0, root(0.5 * deviator_square(s)));
  const Uncertain pressure = v.get("pressure");
  Uncertain floor{number_option(p, "pressure", "pressure_min"), 0};
  if (v.get("density").value > 0) {
    const Uncertain rounding = v.get("density") * noise_square(v, p, "velocity");
    floor = {std::max(floor.value, rounding.value), rounding.error};
  }
  v.put("pressure_floor", 0, floor);
  const Verdict low = fails(exceeds(pressure - v.get("pressure_floor"), 0));
  v.note(Reason::low_pressure, low);
  v.put("mu", 0, unless({low}, v.get("shear_stress") / pressure));

  const Principal principal = principal_of(s);
  for (std::size_t k = 0; k < 3; ++k)
    v.put("principal_stress", static_cast<int>(k), {principal.values[k], principal.error});
  const Uncertain upper = principal.relative_gap(0);
  const Uncertain lower = principal.relative_gap(1);
  const Verdict zero{principal.largest() == 0, principal.largest() > principal.error || principal.error == 0};
  v.note(Reason::degenerate_stress_axes, zero);
  v.put("principal_gap", 0, unless({zero}, {std::min(upper.value, lower.value), std::max(upper.error, lower.error)}));

  v.put("mean_extreme_stress", 0, -0.5 * (v.get("principal_stress", 0) + v.get("principal_stress", 2)));

  const double gap = number_option(p, "principal_axes", "gap");
  const std::array<Verdict, 2> closed{fails(exceeds(upper, gap)), fails(exceeds(lower, gap))};
  for (const Verdict& c : closed) v.note(Reason::degenerate_stress_axes, c);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::array<Uncertain, 3> axis = signed_axis(principal.axes[k], principal.axis_error(k));
    for (std::size_t a = 0; a < 3; ++a)
      v.put("principal_axes", static_cast<int>(3 * k + a),
            unless({closed[k == 0 ? 0 : k - 1], closed[k == 2 ? 1 : k]}, axis[a]));
  }

  const Uncertain least = -1.0 * v.get("principal_stress", 0);
  const Uncertain most = -1.0 * v.get("principal_stress", 2);
  // The smaller stress must be positive beyond the rounding of the larger, √3 2⁻²⁴.
  const Verdict tensile = fails(exceeds(least - std::sqrt(3.0) * float_rounding * most, 0));
  v.note(Reason::tensile_stress, tensile);
  v.put("mu_mohr_coulomb", 0, unless({low, tensile}, (most - least) / (2.0 * root(most * least))));

  // At ±(π/4 - φ_f/2) from the most compressive axis, tan φ_f = μ_MC: |d atan μ| ≤ |dμ|.
  const Uncertain mu = v.get("mu_mohr_coulomb");
  const double angle = std::numbers::pi / 4 - std::atan(mu.value) / 2;
  const Uncertain cosine{std::cos(angle), mu.error / 2};
  const Uncertain sine{std::sin(angle), mu.error / 2};
  for (int a = 0; a < 3; ++a) {
    const Uncertain along = cosine * v.get("principal_axes", 6 + a);
    const Uncertain across = sine * v.get("principal_axes", a);
    v.put("slip_lines", a, unless({closed[0], closed[1], low, tensile}, along + across));
    v.put("slip_lines", 3 + a, unless({closed[0], closed[1], low, tensile}, along - across));
  }
}

void rate_fields(Voxel& v, const Pipeline& p) {
  const UncertainTensor l = v.tensor("velocity_gradient");
  Verdict missing{false, true};
  for (const Uncertain& x : l) missing.yes = missing.yes || x.undefined();
  v.put("shear_rate", 0, unless({missing}, root(2.0 * deviator_square(symmetric(l)))));

  const Uncertain rate = v.get("shear_rate");
  const Uncertain pressure = v.get("pressure");
  const Uncertain d = v.get("mean_diameter");
  const Verdict low = fails(exceeds(pressure - v.get("pressure_floor"), 0));
  v.put("inertial_number", 0,
        unless({any_undefined(rate, d), low}, rate * d * root(v.get("density") / v.get("phi") / pressure)));

  const Uncertain mu = v.get("mu");
  const Verdict no_input = any_undefined(rate, mu);
  const Verdict isotropic = fails(exceeds(mu, number_option(p, "fluidity", "mu_min")));
  if (no_input.sure && !no_input.yes) v.note(Reason::no_shear_stress, isotropic);
  v.put("fluidity", 0, unless({no_input, isotropic}, rate / mu));

  if (!missing.yes) {
    const Principal stress = principal_of(v.tensor("stress"));
    const Principal strain = principal_of(l);
    const Verdict no_stress_axis = fails(exceeds(stress.relative_gap(1), number_option(p, "principal_axes", "gap")));
    const Verdict closed = fails(exceeds(strain.relative_gap(1), number_option(p, "coaxiality_angle", "gap")));
    const Verdict still = fails(exceeds(rate, number_option(p, "coaxiality_angle", "shear_rate_min")));
    v.note(Reason::degenerate_stress_axes, no_stress_axis);
    v.note(Reason::degenerate_strain_axes, closed);
    v.note(Reason::degenerate_strain_axes, still);
    v.put("coaxiality_angle", 0,
          unless({no_stress_axis, closed, still},
                 {angle_between(stress.axes[2], strain.axes[2]), stress.axis_error(2) + strain.axis_error(2)}));
  } else {
    v.put("coaxiality_angle", 0, undefined_value());
  }
}

void ratio_fields(Voxel& v, const Pipeline& p) {
  const Uncertain g = v.get("fluidity");
  const Uncertain d = v.get("mean_diameter");
  const Uncertain t = v.get("temperature");
  const Uncertain w = v.get("rotational_fluctuation");
  const double t_min = number_option(p, "gd_over_dv", "temperature_min");
  const Uncertain u_noise = noise_square(v, p, "velocity");
  const Verdict cold = fails(fluctuates(t, t_min, u_noise));
  const Verdict no_spin = fails(fluctuates(w, number_option(p, "g_over_domega", "rotational_fluctuation_min"),
                                           noise_square(v, p, "angular_velocity")));

  v.put("rotational_temperature", 0, d * d * w / 10);

  const Verdict no_gd = any_undefined(g, d, t);
  if (no_gd.sure && !no_gd.yes) v.note(Reason::no_fluctuation, cold);
  v.put("gd_over_dv", 0, unless({no_gd, cold}, g * d / root(t)));

  const Verdict no_gw = any_undefined(g, w);
  if (no_gw.sure && !no_gw.yes) v.note(Reason::no_spin_fluctuation, no_spin);
  v.put("g_over_domega", 0, unless({no_gw, no_spin}, g / root(w)));

  const Verdict no_tw = any_undefined(t, d, w);
  // T = temperature_min itself is a value of δv here.
  const Verdict colder{t.value < t_min || t.value < u_noise.value, cold.sure};
  if (no_tw.sure && !no_tw.yes) {
    v.note(Reason::no_fluctuation, colder);
    v.note(Reason::no_spin_fluctuation, no_spin);
  }
  v.put("dv_over_d_domega", 0, unless({no_tw, colder, no_spin}, root(t) / (d * root(w))));
}

/// ∂u_i/∂x_j at component 3 i + j by differences: central, towards the one side that has neighbours (three points, or
/// two), or none.
void central_gradient(Voxel& v, const VoxelBox& box, const std::vector<bool>& active, const UncertainField& u,
                      std::size_t n, const std::string& field, Reason none = Reason::no_gradient) {
  const auto defined = [&](int axis, int by) -> std::optional<std::size_t> {
    const auto m = box.index(shifted(box.coord(n), axis, by));
    if (!m || !active[*m] || u.at(*m).undefined()) return std::nullopt;
    return m;
  };
  const double h = box.voxel();
  for (int axis = 0; axis < 3; ++axis) {
    const auto below = defined(axis, -1);
    const auto above = defined(axis, 1);
    if (defined(axis, 0)) {
      v.note(none, {!below && !above, true});
      v.note(Reason::one_sided_gradient, {below.has_value() != above.has_value(), true});
    }
    for (int i = 0; i < u.components; ++i) {
      Uncertain d = undefined_value();
      if (defined(axis, 0) && below && above) {
        d = (u.at(*above, i) - u.at(*below, i)) / (2 * h);
      } else if (defined(axis, 0) && (below || above)) {
        const int side = above ? 1 : -1;
        const Uncertain u0 = u.at(n, i);
        const Uncertain u1 = u.at(*defined(axis, side), i);
        const auto next = defined(axis, 2 * side);
        // -3 u₀ + 4 u₁ - u₂ over 2h, or u₁ - u₀ over h.
        d = next ? static_cast<double>(side) * ((4.0 * u1 - 3.0 * u0 - u.at(*next, i)) / (2 * h))
                 : static_cast<double>(side) * ((u1 - u0) / h);
      }
      v.put(field, 3 * i + axis, d);
    }
  }
}

/// -Σ s s·(ρ g - (1 - (s·s')²) ∇p) over the slip lines s, s'; ∇p stands where the drift is to be.
void drift(Voxel& v, const Pipeline& p) {
  const auto& gravity = option<std::vector<double>>(p.stages, "spot_drift", "gravity");
  Uncertain sine;
  for (int a = 0; a < 3; ++a) sine = sine + v.get("slip_lines", a) * v.get("slip_lines", 3 + a);
  std::array<Uncertain, 3> force;
  Verdict missing{false, true};
  for (std::size_t a = 0; a < 3; ++a) {
    const Uncertain gradient = v.get("spot_drift", static_cast<int>(a));
    const Verdict without = any_undefined(gradient, sine);
    missing = {missing.yes || without.yes, missing.sure && without.sure};
    force[a] = gravity[a] * v.get("density") - (Uncertain{1, 0} - sine * sine) * gradient;
  }
  std::array<Uncertain, 3> sum{};
  for (int line : {0, 3}) {
    Uncertain along;
    for (int a = 0; a < 3; ++a) along = along + v.get("slip_lines", line + a) * force[static_cast<std::size_t>(a)];
    for (int a = 0; a < 3; ++a)
      sum[static_cast<std::size_t>(a)] = sum[static_cast<std::size_t>(a)] - along * v.get("slip_lines", line + a);
  }
  for (int a = 0; a < 3; ++a)
    v.put("spot_drift", a, unless({{missing.yes, missing.yes || missing.sure}}, sum[static_cast<std::size_t>(a)]));
}

/// The sums of deviations that are divided by a share of the variance, and the gradient of their mean.
struct Fluctuation {
  const char* field;
  const char* gradient;
};
constexpr Fluctuation fluctuations[] = {{"temperature", "velocity_gradient"},
                                        {"rotational_fluctuation", "angular_velocity_gradient"}};

std::string share_name(const Fluctuation& f) {
  return std::string(f.field) + "_share";
}
bool corrected(const Fluctuation& f, const Pipeline& p) {
  return option<std::string>(p.stages, f.field, "mode") == "one_pass_corrected";
}

/// T - (c²/12) L:L over what is left of the variance, undefined where negative.
void correct_fluctuation(Voxel& v, const Pipeline& p, const Fluctuation& f, const Uncertain& one_pass) {
  Uncertain squares;
  for (const Uncertain& l : v.tensor(f.gradient)) squares = squares + l * l;
  const Uncertain t = one_pass - (p.cutoff * p.cutoff / 12) * squares / v.get(share_name(f));
  if (t.undefined()) {
    v.put(f.field, 0, undefined_value());
    return;
  }
  const Verdict negative = exceeds(-1.0 * t, 0);
  v.note(Reason::negative_temperature, negative);
  v.put(f.field, 0, unless({negative}, t));
}

}  // namespace

Uncertain in_doubt() {
  return {0, std::numeric_limits<double>::infinity()};
}
bool is_in_doubt(const Uncertain& a) {
  return !a.undefined() && !std::isfinite(a.error);
}

Derived derive(const VoxelBox& box, const std::vector<bool>& active, const UncertainFields& base,
               const Pipeline& pipeline) {
  Derived out{{}, std::vector<std::uint32_t>(box.size()), std::vector<std::uint32_t>(box.size())};
  const auto central = [&](const char* gradient) {
    return option<std::string>(pipeline.stages, gradient, "method") == "central";
  };
  const auto add = [&](const std::string& name, int components) {
    out.fields[name] = {components,
                        std::vector<Uncertain>(box.size() * static_cast<std::size_t>(components), undefined_value())};
  };
  for (const char* name : {"shear_rate", "pressure", "pressure_floor", "shear_stress", "mu", "inertial_number",
                           "fluidity", "gd_over_dv", "g_over_domega", "dv_over_d_domega", "mu_mohr_coulomb",
                           "coaxiality_angle", "rotational_temperature", "principal_gap", "mean_extreme_stress"})
    add(name, 1);
  add("principal_stress", 3);
  add("spot_drift", 3);
  add("slip_lines", 6);
  add("principal_axes", 9);
  for (const Fluctuation& f : fluctuations) {
    if (central(f.gradient)) add(f.gradient, 9);
    if (corrected(f, pipeline)) add(f.field, 1);
  }

  for (std::size_t n = 0; n < box.size(); ++n) {
    if (!active[n]) continue;
    Voxel v(base, out, n);
    v.note(Reason::no_material, {!(base.at("phi").at(n).value > 0), true});
    if (central("velocity_gradient")) central_gradient(v, box, active, base.at("velocity"), n, "velocity_gradient");
    if (central("angular_velocity_gradient"))
      central_gradient(v, box, active, base.at("angular_velocity"), n, "angular_velocity_gradient");
    for (const Fluctuation& f : fluctuations) {
      // No grain alone is between nothing and a thousandth of its own mean.
      v.note(Reason::lone_particles, {v.get(share_name(f)).value <= 1e-3, true});
      if (corrected(f, pipeline)) correct_fluctuation(v, pipeline, f, base.at(f.field).at(n));
    }
    stress_fields(v, pipeline);
    rate_fields(v, pipeline);
    ratio_fields(v, pipeline);
  }
  for (std::size_t n = 0; n < box.size(); ++n) {
    if (!active[n]) continue;
    Voxel v(base, out, n);
    central_gradient(v, box, active, out.fields.at("mean_extreme_stress"), n, "spot_drift", Reason::no_stress_gradient);
    drift(v, pipeline);
  }
  return out;
}

}  // namespace grainvdb::testing
