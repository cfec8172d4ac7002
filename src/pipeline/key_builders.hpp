#pragma once
/// Declarations of keys of common kinds.
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/schema.hpp"

namespace grainvdb {

inline constexpr const char* no_unit_hint = "Numbers are given without their unit, in the unit system of the dump.";

using ApplyValue = std::function<void(Pipeline&, const ConfigValue&)>;

/// A positive number.
KeyInfo number_key(std::string section, std::string name, std::string unit, std::string help, ApplyValue apply);

/// A list of texts; one text stands for a list of one.
KeyInfo texts_key(std::string section, std::string name, std::string help, std::vector<std::string> choices,
                  ApplyValue apply);

/// Paths and patterns relative to the folder of that file, whose own name has no wildcards.
std::vector<std::string> paths_beside(const std::string& file, const std::vector<std::string>& paths);

/// The value of a key of paths and patterns, which are relative to the folder of the pipeline file.
std::vector<std::string> input_paths(const Pipeline& pipeline, const ConfigValue& value);

/// Three lengths.
KeyInfo vector_key(std::string section, std::string name, std::string help, ApplyValue apply);

/// The two corners of a box in that section, `lo` and `hi`; .inf leaves a side open.
using BoxOf = std::function<std::optional<std::pair<Vec3, Vec3>>&(Pipeline&)>;
void add_box_keys(Schema& schema, const std::string& section, const BoxOf& corners);

/// The value of a vector key.
Vec3 vector_of(const ConfigValue& value);

}  // namespace grainvdb
