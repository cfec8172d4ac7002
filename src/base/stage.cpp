#include "grainvdb/stage.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>

namespace grainvdb {

double sphere_volume(double radius) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

void StageRegistry::add(Stage stage) {
  if (find(stage.name) != nullptr)
    throw std::invalid_argument("a stage named '" + stage.name + "' is registered already");
  stages_.push_back(std::move(stage));
}

const Stage* StageRegistry::find(const std::string& name) const {
  const auto it = std::find_if(stages_.begin(), stages_.end(), [&](const Stage& s) { return s.name == name; });
  return it == stages_.end() ? nullptr : &*it;
}

StageSettings StageRegistry::default_settings() const {
  StageSettings settings;
  for (const Stage& stage : stages_) {
    OptionValues& values = settings[stage.name];
    for (const OptionInfo& o : stage.options) values[o.name] = o.default_value;
  }
  return settings;
}

}  // namespace grainvdb
