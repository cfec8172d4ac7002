#include "pipeline/half_step_keys.hpp"

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace grainvdb {
namespace {

const std::string section = "input.contacts.half_step";

HalfStep& half_step_of(Pipeline& p) {
  auto& half_step = p.input.contacts.half_step;
  if (!half_step) half_step.emplace();
  return *half_step;
}

KeyInfo number(const char* name, const char* unit, const char* help, double HalfStep::*to) {
  KeyInfo key{section, name, ValueType::number, help, unit};
  key.minimum = 0;
  key.above_minimum = true;
  key.apply = [to](Pipeline& p, const ConfigValue& v) { half_step_of(p).*to = std::get<double>(v); };
  return key;
}

KeyInfo types(const char* name, const char* help, std::vector<int> HalfStep::*to) {
  KeyInfo key{section, name, ValueType::integers, help};
  key.minimum = 0;
  key.maximum = std::numeric_limits<int>::max();
  key.apply = [to](Pipeline& p, const ConfigValue& v) {
    for (const std::int64_t type : std::get<std::vector<std::int64_t>>(v))
      (half_step_of(p).*to).push_back(static_cast<int>(type));
  };
  return key;
}

}  // namespace

void add_half_step_keys(Schema& schema) {
  schema.sections.push_back({section,
                             "Takes off the error of half a step in the damping of dumped contact forces. The particle "
                             "dumps must hold fx fy fz."});
  KeyInfo law{section, "law", ValueType::text,
              "Where the normal damping comes from: 'rate' (LAMMPS gran/hooke: gamma_n times the effective mass), "
              "'hooke' or 'hertz' (LIGGGHTS: from the coefficient of restitution)."};
  law.required = true;
  law.choices = {"rate", "hooke", "hertz"};
  law.apply = [](Pipeline& p, const ConfigValue& v) {
    const auto& name = std::get<std::string>(v);
    half_step_of(p).law = name == "rate" ? DampingLaw::rate : name == "hooke" ? DampingLaw::hooke : DampingLaw::hertz;
  };
  schema.keys.push_back(law);
  schema.keys.push_back(number("dt", "time", "Time step of the run; input.dt unless given.", &HalfStep::dt));
  schema.keys.push_back(number("rate", "1/time", "gamma_n of the pair style, for the law 'rate'.", &HalfStep::rate));
  schema.keys.push_back(number("youngs_modulus", "force/length^2",
                               "Young's modulus of the grains, for 'hooke' and 'hertz'.", &HalfStep::youngs_modulus));
  KeyInfo poisson =
      number("poisson_ratio", "", "Poisson's ratio of the grains, for 'hooke' and 'hertz'.", &HalfStep::poisson_ratio);
  poisson.above_minimum = false;
  poisson.maximum = 0.5;
  schema.keys.push_back(poisson);
  KeyInfo restitution =
      number("restitution", "", "Coefficient of restitution, for 'hooke' and 'hertz'.", &HalfStep::restitution);
  restitution.maximum = 1;
  schema.keys.push_back(restitution);
  schema.keys.push_back(number("characteristic_velocity", "length/time", "Characteristic velocity, for 'hooke'.",
                               &HalfStep::characteristic_velocity));
  KeyInfo friction{section, "friction", ValueType::number,
                   "Coefficient of friction: the tangential forces of contacts that slide follow the normal ones; "
                   "without it they are left as they are."};
  friction.minimum = 0;
  friction.apply = [](Pipeline& p, const ConfigValue& v) { half_step_of(p).friction = std::get<double>(v); };
  schema.keys.push_back(friction);
  schema.keys.push_back(types("still_types", "Types of particles that their forces do not move, as walls of grains.",
                              &HalfStep::still_types));
  schema.keys.push_back(types("frozen_types", "Such types that count as infinitely heavy in contacts (fix freeze).",
                              &HalfStep::frozen_types));
  KeyInfo whole{section, "whole_steps", ValueType::integers,
                "Steps whose forces are right as they are: the first step of each run command."};
  whole.minimum = 0;
  whole.apply = [](Pipeline& p, const ConfigValue& v) {
    half_step_of(p).whole_steps = std::get<std::vector<std::int64_t>>(v);
  };
  schema.keys.push_back(whole);
}

void check_half_step(const Pipeline& pipeline) {
  const auto& half_step = pipeline.input.contacts.half_step;
  if (!half_step) return;
  std::set<std::string> wanted{"youngs_modulus", "poisson_ratio", "restitution"};
  if (half_step->law == DampingLaw::hooke) wanted.insert("characteristic_velocity");
  if (half_step->law == DampingLaw::rate) wanted = {"rate"};
  std::string needed, given;
  bool agree = true;
  for (const std::string name : {"rate", "youngs_modulus", "poisson_ratio", "restitution", "characteristic_velocity"}) {
    const bool there = pipeline.where.contains(section + '.' + name);
    if (wanted.contains(name)) needed += (needed.empty() ? "" : ", ") + name;
    if (there) given += (given.empty() ? "" : ", ") + name;
    agree = agree && wanted.contains(name) == there;
  }
  if (!agree)
    throw ConfigError({pipeline.location(section), "the keys of " + section + " are not those of its law",
                       given.empty() ? "none" : given, needed, "grainvdb schema lists what each law needs"});
  if (half_step->dt == 0)
    throw ConfigError({pipeline.location(section),
                       section + " needs the time step of the run",
                       {},
                       section + ".dt, or input.dt",
                       {}});
}

}  // namespace grainvdb
