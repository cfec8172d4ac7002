// Every field at every voxel against the brute force, for several scenes and all named variants.
//
// Two comparisons are made. "From the particles": the brute force does everything in double; each value may be off by
// what storing floats along the way costs, carried through the formulas. "From the program's own fields": derived
// fields are formed again from the float fields that were written, which leaves only their own rounding.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/compare.hpp"
#include "support/derived.hpp"
#include "support/reference.hpp"
#include "support/run_in_memory.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::brute_force_test {
namespace {

struct Case {
  const char* name;
  Scene (*scene)();
  std::function<void(Pipeline&)> set;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

std::string text(const char* s) {
  return s;
}

/// Thresholds far above rounding and far below what flows: no voxel hangs on the noise of a sum that is zero.
void set_thresholds(Pipeline& p) {
  set_option(p, "pressure", "pressure_min", 1e-9);
  set_option(p, "gd_over_dv", "temperature_min", 1e-9);
  set_option(p, "g_over_domega", "rotational_fluctuation_min", 1e-9);
}

void defaults(Pipeline&) {}

void mass_profile_kernel(Pipeline& p) {
  set_option(p, "velocity", "weighting", text("mass"));
  set_option(p, "temperature", "mode", text("two_pass_profile"));
  set_option(p, "rotational_fluctuation", "mode", text("two_pass_profile"));
  set_option(p, "rotational_fluctuation", "homogeneous", std::vector<std::string>{"y"});
  set_option(p, "kinetic_stress", "reference", text("instantaneous"));
  set_option(p, "velocity_gradient", "method", text("kernel"));
  set_option(p, "contact_stress", "line_integral", text("gauss3"));
}

void one_pass(Pipeline& p) {
  set_option(p, "temperature", "mode", text("one_pass"));
  set_option(p, "rotational_fluctuation", "mode", text("one_pass"));
  set_option(p, "velocity_gradient", "method", text("kernel"));
  set_option(p, "contact_stress", "line_integral", text("gauss1"));
}

void one_pass_corrected(Pipeline& p) {
  set_option(p, "temperature", "mode", text("one_pass_corrected"));
  set_option(p, "kinetic_stress", "reference", text("instantaneous"));
  set_option(p, "contact_stress", "line_integral", text("gauss8"));
}

void mass_one_pass_corrected(Pipeline& p) {
  one_pass_corrected(p);
  set_option(p, "velocity", "weighting", text("mass"));
  set_option(p, "rotational_fluctuation", "mode", text("one_pass_corrected"));
}

void without_self_weight(Pipeline& p) {
  set_option(p, "temperature", "self_weight", text("corrected"));
  set_option(p, "rotational_fluctuation", "self_weight", text("corrected"));
}

void mass_without_self_weight(Pipeline& p) {
  without_self_weight(p);
  set_option(p, "velocity", "weighting", text("mass"));
  set_option(p, "rotational_fluctuation", "mode", text("one_pass"));
}

void one_pass_corrected_without_self_weight(Pipeline& p) {
  without_self_weight(p);
  set_option(p, "temperature", "mode", text("one_pass_corrected"));
  set_option(p, "rotational_fluctuation", "mode", text("one_pass_corrected"));
  set_option(p, "angular_velocity_gradient", "method", text("kernel"));
}

bool gradient_taken_off(const Pipeline& p, const char* stage) {
  return option<std::string>(p.stages, stage, "mode") == "one_pass_corrected";
}

const char* const sums[] = {"phi",
                            "density",
                            "velocity",
                            "mean_diameter",
                            "temperature",
                            "angular_velocity",
                            "rotational_fluctuation",
                            "contact_stress",
                            "kinetic_stress"};

const char* const fluctuations[] = {"temperature", "rotational_fluctuation"};
const std::pair<const char*, const char*> gradients[] = {{"velocity_gradient", "gradient_by_kernel"},
                                                         {"angular_velocity_gradient", "spin_gradient_by_kernel"}};

class BruteForce : public ::testing::TestWithParam<Case> {
 protected:
  BruteForce() : scene(GetParam().scene()), pipeline(scene.pipeline(all_fields())) {
    set_thresholds(pipeline);
    GetParam().set(pipeline);
    result = run(pipeline, scene.frames);
    reference.emplace(coarse_grain(scene.frames, pipeline));
    for (int frames : reference->any_frames) active.push_back(frames > 0);
  }

  void check_voxels();
  void check_sums();
  void check_derived_from_particles();
  void check_derived_from_own_fields();

  const VoxelBox& box() const { return reference->box; }
  const Written& written() const { return result.only(); }
  bool by_kernel(const char* gradient) const {
    return option<std::string>(pipeline.stages, gradient, "method") == "kernel";
  }

  void check(const std::string& name, const std::function<Uncertain(std::size_t, int)>& expected,
             const std::function<double(std::size_t, int)>& magnitude, const std::string& label) {
    const Agreement a = compare(written().field(name), box(), active, expected, magnitude);
    EXPECT_EQ(a.failures, 0U) << name << ", " << a.failures << " of " << a.checked << ": " << a.first_failure;
    EXPECT_GT(a.checked, 0U) << name;
    RecordProperty(label + name, std::to_string(a.worst_relative) + " of magnitude, " +
                                     std::to_string(a.worst_of_bound) + " of bound, in doubt " +
                                     std::to_string(a.in_doubt) + "/" + std::to_string(a.checked + a.in_doubt));
    if (std::getenv("GRAINVDB_AGREEMENT") != nullptr)
      std::printf("%-28s %-24s %9.2e of magnitude %9.2e of bound, %zu checked, %zu in doubt\n", label.c_str(),
                  name.c_str(), a.worst_relative, a.worst_of_bound, a.checked, a.in_doubt);
  }

  void check_derived(const Derived& d, const std::string& label) {
    for (const auto& [name, field] : d.fields)
      check(
          name, [&f = field](std::size_t n, int c) { return f.at(n, c); },
          [&f = field](std::size_t n, int c) { return std::abs(f.at(n, c).value); }, label);
    std::size_t wrong = 0;
    for (std::size_t n = 0; n < box().size(); ++n)
      if (active[n] && ((written().mask_at(box().coord(n)) ^ d.mask[n]) & ~d.unsure[n]) != 0) ++wrong;
    EXPECT_EQ(wrong, 0U) << "mask";
  }

  Scene scene;
  Pipeline pipeline;
  Result result;
  std::optional<Reference> reference;
  std::vector<bool> active;
};

void BruteForce::check_voxels() {
  EXPECT_EQ(topology_differences(*written().field("phi").topology, box(), active), 0U);
  for (std::size_t n = 0; n < box().size(); ++n) {
    if (!active[n]) continue;
    ASSERT_EQ(written().field("frames").at(box().coord(n)), static_cast<float>(reference->any_frames[n]));
  }
}

void BruteForce::check_sums() {
  for (const std::string name : sums) {
    if (std::count(std::begin(fluctuations), std::end(fluctuations), name) > 0 &&
        gradient_taken_off(pipeline, name.c_str()))
      continue;
    const ReferenceField& f = reference->fields.at(name);
    check(
        name, [&](std::size_t n, int c) { return f.expected(n, c); },
        [&](std::size_t n, int c) { return f.magnitude[f.index(n, c)]; }, "sums ");
  }
  const ReferenceField& contact = reference->fields.at("contact_stress");
  const ReferenceField& kinetic = reference->fields.at("kinetic_stress");
  check(
      "stress", [&](std::size_t n, int c) { return stored(contact.expected(n, c) + kinetic.expected(n, c)); },
      [&](std::size_t n, int c) {
        return contact.magnitude[9 * n + static_cast<std::size_t>(c)] +
               kinetic.magnitude[9 * n + static_cast<std::size_t>(c)];
      },
      "sums ");
  for (const auto& [name, source] : gradients) {
    if (!by_kernel(name)) continue;
    const ReferenceField& gradient = reference->fields.at(source);
    check(
        name, [&](std::size_t n, int c) { return gradient.expected(n, c); },
        [&](std::size_t n, int c) { return gradient.magnitude[gradient.index(n, c)]; }, "sums ");
  }
}

void BruteForce::check_derived_from_particles() {
  UncertainFields base;
  const auto add = [&](const std::string& name, const std::string& source) {
    const ReferenceField& f = reference->fields.at(source);
    UncertainField& u = base[name];
    u.components = f.components;
    for (std::size_t n = 0; n < box().size(); ++n)
      for (int c = 0; c < f.components; ++c) u.values.push_back(f.expected(n, c));
  };
  for (const char* name : sums) add(name, name);
  for (const auto& [name, source] : gradients)
    if (by_kernel(name)) add(name, source);
  for (const char* name : {"temperature_share", "rotational_fluctuation_share"}) add(name, name);
  UncertainField& stress = base["stress"];
  stress.components = 9;
  for (std::size_t i = 0; i < base["contact_stress"].values.size(); ++i)
    stress.values.push_back(stored(base["contact_stress"].values[i] + base["kinetic_stress"].values[i]));
  check_derived(derive(box(), active, base, pipeline), "derived from particles ");
}

void BruteForce::check_derived_from_own_fields() {
  UncertainFields base;
  for (const char* name : {"phi", "density", "velocity", "mean_diameter", "temperature", "angular_velocity",
                           "rotational_fluctuation", "stress", "velocity_gradient", "angular_velocity_gradient"}) {
    if (std::string(name).ends_with("_gradient") && !by_kernel(name)) continue;
    const FieldCopy& f = written().field(name);
    UncertainField& u = base[name];
    u.components = f.meta.components;
    for (std::size_t n = 0; n < box().size(); ++n)
      for (int c = 0; c < u.components; ++c) u.values.push_back({static_cast<double>(f.at(box().coord(n), c)), 0});
  }
  // Those before the gradient part is taken off are written by the other mode.
  Pipeline uncorrected = pipeline;
  for (const char* name : fluctuations)
    if (gradient_taken_off(pipeline, name)) set_option(uncorrected, name, "mode", text("one_pass"));
  const Result other = run(uncorrected, scene.frames);
  for (const std::string name : fluctuations) {
    // What was left of the variance is not written.
    const ReferenceField& share = reference->fields.at(name + "_share");
    for (std::size_t n = 0; n < box().size(); ++n) {
      base[name].values[n].value = static_cast<double>(other.only().field(name).at(box().coord(n)));
      base[name + "_share"].values.push_back(
          option<std::string>(pipeline.stages, name, "self_weight") == "none" ? Uncertain{1, 0} : share.expected(n));
    }
  }
  const Derived d = derive(box(), active, base, pipeline);
  check_derived(d, "derived from own fields ");
  // The inputs are exact: nothing is in doubt but what is made of the smallest numbers a float can hold.
  for (std::size_t n = 0; n < box().size(); ++n) {
    if (d.unsure[n] == 0) continue;
    EXPECT_LT(d.fields.at("shear_stress").at(n).value, 1e-30) << "voxel " << n << ", bits " << d.unsure[n];
  }
}

TEST_P(BruteForce, EveryFieldAtEveryVoxel) {
  check_voxels();
  check_sums();
  check_derived_from_particles();
  check_derived_from_own_fields();
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, BruteForce,
    ::testing::Values(
        Case{"periodic_defaults", periodic_scene, defaults},
        Case{"periodic_mass_profile_kernel", periodic_scene, mass_profile_kernel},
        Case{"periodic_one_pass_corrected", periodic_scene, one_pass_corrected},
        Case{"walled_defaults", walled_scene, defaults},
        Case{"walled_mass_profile_kernel", walled_scene, mass_profile_kernel},
        Case{"walled_one_pass", walled_scene, one_pass},
        Case{"walled_mass_one_pass_corrected", walled_scene, mass_one_pass_corrected},
        Case{"dilute_defaults", dilute_scene, defaults}, Case{"dilute_one_pass", dilute_scene, one_pass},
        Case{"periodic_without_self_weight", periodic_scene, without_self_weight},
        Case{"walled_mass_without_self_weight", walled_scene, mass_without_self_weight},
        Case{"walled_one_pass_corrected_without_self_weight", walled_scene, one_pass_corrected_without_self_weight},
        Case{"dilute_without_self_weight", dilute_scene, without_self_weight},
        Case{"dilute_one_pass_corrected_without_self_weight", dilute_scene, one_pass_corrected_without_self_weight}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace
}  // namespace grainvdb::testing::brute_force_test
