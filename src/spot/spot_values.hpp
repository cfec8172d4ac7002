#pragma once
/// The checked values of a spot file, by type, and the places that errors name.
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "grainvdb/box.hpp"
#include "grainvdb/error.hpp"
#include "pipeline/load_config.hpp"

namespace grainvdb::spot {

/// The checked values of a file, by type.
class Values {
 public:
  Values(const std::string& file, const CheckedConfig& config) : file_(file), config_(config) {}

  template <class T>
  std::optional<T> find(const std::string& key) const {
    const auto it = config_.values.find(key);
    if (it == config_.values.end()) return std::nullopt;
    return std::get<T>(it->second);
  }
  template <class T>
  T get(const std::string& key) const {
    return find<T>(key).value();
  }
  bool has_section(const std::string& section) const { return config_.places.contains(section); }
  Location where(const std::string& key) const {
    const auto it = config_.places.find(key);
    return it == config_.places.end() ? Location{file_} : it->second;
  }
  Vec3 vector(const std::string& key) const {
    const auto v = get<std::vector<double>>(key);
    return {v[0], v[1], v[2]};
  }

 private:
  const std::string& file_;
  const CheckedConfig& config_;
};

/// make(), whose errors stand at that place.
template <class F>
auto placed(const Location& where, F make) {
  try {
    return make();
  } catch (const ConfigError& error) {
    Problem problem = error.problem();
    problem.where = where;
    throw ConfigError(problem);
  }
}

}  // namespace grainvdb::spot
