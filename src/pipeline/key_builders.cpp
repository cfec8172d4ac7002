#include "pipeline/key_builders.hpp"

#include <utility>

namespace grainvdb {

KeyInfo number_key(std::string section, std::string name, std::string unit, std::string help, ApplyValue apply) {
  KeyInfo key{std::move(section), std::move(name), ValueType::number, std::move(help), std::move(unit)};
  key.minimum = 0;
  key.above_minimum = true;
  key.hint = no_unit_hint;
  key.apply = std::move(apply);
  return key;
}

KeyInfo texts_key(std::string section, std::string name, std::string help, std::vector<std::string> choices,
                  ApplyValue apply) {
  KeyInfo key{std::move(section), std::move(name), ValueType::texts, std::move(help)};
  key.choices = std::move(choices);
  key.apply = std::move(apply);
  return key;
}

KeyInfo vector_key(std::string section, std::string name, std::string help, ApplyValue apply) {
  KeyInfo key{std::move(section), std::move(name), ValueType::numbers, std::move(help), "length"};
  key.fewest = key.most = 3;
  key.hint = no_unit_hint;
  key.apply = std::move(apply);
  return key;
}

Vec3 vector_of(const ConfigValue& value) {
  const auto& v = std::get<std::vector<double>>(value);
  return {v.at(0), v.at(1), v.at(2)};
}

}  // namespace grainvdb
