#include "support/soundness.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <sstream>

#include "grainvdb/mask.hpp"

namespace grainvdb::testing {
namespace {

std::uint32_t bits(std::initializer_list<Reason> reasons) {
  std::uint32_t all = 0;
  for (Reason r : reasons) all |= static_cast<std::uint32_t>(r);
  return all;
}

/// The reasons that leave all components of a field undefined, by their definitions. Those that two fields may have
/// independently (negative_temperature, lone_particles) are not among them.
std::uint32_t undefined_by(const std::string& field) {
  const std::uint32_t flow = bits({Reason::no_material});
  const std::uint32_t rate = bits({Reason::no_material, Reason::no_gradient});
  const std::uint32_t ratio = bits({Reason::low_pressure});
  const std::uint32_t fluidity = rate | ratio | bits({Reason::no_shear_stress});
  static const std::map<std::string, std::uint32_t> known{
      {"velocity", flow},
      {"mean_diameter", flow},
      {"temperature", flow},
      {"angular_velocity", flow},
      {"rotational_fluctuation", flow},
      {"rotational_temperature", flow},
      {"velocity_gradient", flow},
      {"shear_rate", rate},
      {"mu", ratio},
      {"inertial_number", rate | ratio},
      {"fluidity", fluidity},
      {"gd_over_dv", fluidity | bits({Reason::no_fluctuation})},
      {"g_over_domega", fluidity | bits({Reason::no_spin_fluctuation})},
      {"dv_over_d_domega", flow | bits({Reason::no_spin_fluctuation})},
      {"mu_mohr_coulomb", ratio | bits({Reason::tensile_stress})},
      {"slip_lines", ratio | bits({Reason::tensile_stress})},
      {"spot_drift", ratio | bits({Reason::tensile_stress, Reason::no_stress_gradient})},
      {"coaxiality_angle", rate | bits({Reason::degenerate_strain_axes})}};
  const auto it = known.find(field);
  return it == known.end() ? 0 : it->second;
}

/// The field of which this is the standard error; empty for any other.
std::string error_of(const std::string& field) {
  const std::string ending = "_error";
  return field.ends_with(ending) ? field.substr(0, field.size() - ending.size()) : std::string();
}

bool cannot_be_negative(const std::string& field) {
  static const std::set<std::string> names{"phi",
                                           "density",
                                           "mean_diameter",
                                           "temperature",
                                           "rotational_fluctuation",
                                           "rotational_temperature",
                                           "shear_rate",
                                           "mu",
                                           "inertial_number",
                                           "fluidity",
                                           "gd_over_dv",
                                           "g_over_domega",
                                           "shear_stress",
                                           "frames",
                                           "principal_gap",
                                           "dv_over_d_domega",
                                           "mu_mohr_coulomb",
                                           "coaxiality_angle"};
  return names.contains(field) || !error_of(field).empty();
}

/// The first fault of each kind, with the number of its kind.
class Faults {
 public:
  void add(const std::string& kind, const Coord& c, double value, std::uint32_t mask) {
    auto& [count, first] = faults_[kind];
    if (count++ > 0) return;
    std::ostringstream text;
    text << "first at voxel " << c.x << ' ' << c.y << ' ' << c.z << ": " << value << ", mask " << mask;
    first = text.str();
  }
  void add(const std::string& fault) { faults_[fault].first = 1; }
  std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const auto& [kind, fault] : faults_)
      all.push_back(kind + " (" + std::to_string(fault.first) + ")" +
                    (fault.second.empty() ? "" : ", " + fault.second));
    return all;
  }

 private:
  std::map<std::string, std::pair<std::size_t, std::string>> faults_;
};

void check_field(const Written& w, const std::string& name, const FieldCopy& f, Faults& faults) {
  const std::uint32_t says_nothing = bits({Reason::one_sided_gradient});
  const std::uint32_t own = undefined_by(name) | bits({Reason::behind_wall, Reason::near_wall});
  for (std::size_t l = 0; l < f.topology->leaf_count(); ++l)
    for (int v = 0; v < leaf_size; ++v) {
      const Coord c = voxel_at(f.topology->origin(l), v);
      const bool active = f.topology->mask(l).test(v);
      const std::uint32_t mask = w.has_mask && active ? w.mask_at(c) : 0;
      for (int k = 0; k < f.meta.components; ++k) {
        const float x = f.at(c, k);
        if (std::isinf(x)) faults.add(name + ": infinite", c, x, mask);
        if (!active) {
          if (std::isnan(f.meta.background) ? !std::isnan(x) : x != f.meta.background)
            faults.add(name + ": not the background where inactive", c, x, mask);
          continue;
        }
        if (std::isnan(x) && (mask & ~says_nothing) == 0) faults.add(name + ": NaN without a reason", c, x, mask);
        if (!std::isnan(x) && (mask & own) != 0) faults.add(name + ": a number in spite of a reason", c, x, mask);
        if (x < 0 && cannot_be_negative(name)) faults.add(name + ": negative", c, x, mask);
      }
    }
}

void check_error(const Written& w, const std::string& name, const FieldCopy& error, Faults& faults) {
  const FieldCopy& field = w.field(error_of(name));
  error.for_each_active([&](const Coord& c) {
    const std::uint32_t mask = w.mask_at(c);
    for (int k = 0; k < error.meta.components; ++k) {
      const float x = error.at(c, k);
      const bool undefined = std::isnan(field.at(c, k));
      if (undefined && !std::isnan(x)) faults.add(name + ": a number where the field has none", c, x, mask);
      if (!undefined && std::isnan(x) && (mask & bits({Reason::few_blocks})) == 0)
        faults.add(name + ": NaN without few_blocks", c, x, mask);
    }
  });
}

void check_counts(const Result& r, Faults& faults) {
  const Written& last = r.record.times.back();
  if (!last.has_mask) return;
  std::map<std::string, std::size_t> counted;
  for (std::size_t l = 0; l < last.mask_topology->leaf_count(); ++l)
    last.mask_topology->mask(l).for_each([&](int v) {
      const std::uint32_t at = last.mask[l * leaf_size + static_cast<std::size_t>(v)];
      for (const ReasonInfo& reason : reasons())
        if ((at & static_cast<std::uint32_t>(reason.reason)) != 0) ++counted[std::string(reason.name)];
    });
  const std::map<std::string, std::size_t> reported(r.report.masked.begin(), r.report.masked.end());
  if (reported != counted) faults.add("the report's counts of reasons are not those of the mask");
}

}  // namespace

std::vector<std::string> unsoundness(const Result& result) {
  Faults faults;
  for (const Written& w : result.record.times)
    for (const auto& [name, field] : w.fields) {
      if (std::isnan(field.meta.background) && !w.has_mask) faults.add(name + ": written without a mask");
      check_field(w, name, field, faults);
      if (w.has_mask && w.fields.contains(error_of(name))) check_error(w, name, field, faults);
    }
  check_counts(result, faults);
  return faults.texts();
}

}  // namespace grainvdb::testing
