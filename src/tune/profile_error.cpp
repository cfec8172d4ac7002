#include "tune/profile_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "grainvdb/error.hpp"
#include "grainvdb/measurement.hpp"
#include "tune/nine_digits.hpp"

namespace grainvdb {
namespace {

using Texts = std::vector<std::string>;

const Texts& of_both() {
  static const Texts names{"phi", "density", "velocity", "mean_diameter", "temperature"};
  return names;
}
constexpr const char* profile_prefix = "profile.";

const OptionValues* options_of(const Pipeline& pipeline, const std::string& measurement) {
  const auto it = pipeline.measure.find(measurement);
  return it == pipeline.measure.end() ? nullptr : &it->second;
}

template <class T>
const T& get(const OptionValues& options, const std::string& name) {
  return std::get<T>(options.at(name));
}

/// Of the one that the pipeline has; the voxels' where it has both.
const OptionValues* profile_options(const Pipeline& pipeline) {
  const OptionValues* of_voxels = options_of(pipeline, "profile");
  return of_voxels != nullptr ? of_voxels : options_of(pipeline, "plane_profile");
}

bool has_area(const OptionValues& options, const Box& box) {
  if (options.contains("area") && get<double>(options, "area") > 0) return true;
  const std::string& axis = get<std::string>(options, "axis");
  for (std::size_t a = 0; a < 3; ++a)
    if (axis[0] != "xyz"[a] && !box.periodic[a]) return false;
  return true;
}

/// "key=value" of the options that both have.
Texts same_planes(const OptionValues& options, const std::string& measurement) {
  const std::string section = "measure." + measurement + '.';
  Texts set{section + "axis=" + get<std::string>(options, "axis")};
  for (const char* bound : {"from", "to"})
    if (const double x = get<double>(options, bound); x != 0) set.push_back(section + bound + '=' + nine_digits(x));
  return set;
}

/// Rows of one quantity along the axis of a table.
struct Curve {
  const std::vector<double>* position = nullptr;
  std::vector<const std::vector<double>*> components{};
};

const std::vector<double>* column(const Table& table, const std::string& name) {
  for (const TableColumn& c : table.columns)
    if (c.name == name) return &c.values;
  return nullptr;
}

Curve curve(const std::vector<Table>& tables, const Texts& preferred, const std::string& quantity) {
  for (const std::string& name : preferred)
    for (const Table& table : tables) {
      if (table.name != name) continue;
      Curve found{&table.columns.front().values};
      if (const auto* values = column(table, quantity)) found.components.push_back(values);
      for (const char* axis : {"_x", "_y", "_z"})
        if (const auto* values = column(table, quantity + axis)) found.components.push_back(values);
      return found;
    }
  return {};
}

/// The row of a position, which is given to rounding.
std::optional<std::size_t> row_at(const std::vector<double>& positions, double x) {
  const auto above = std::lower_bound(positions.begin(), positions.end(), x);
  for (const auto row : {above, above == positions.begin() ? above : above - 1})
    if (row != positions.end() && std::abs(*row - x) <= 1e-9 * (std::abs(x) + positions.back() - positions.front()))
      return static_cast<std::size_t>(row - positions.begin());
  return std::nullopt;
}

FieldError error_of(const std::string& quantity, const std::vector<Table>& exact, const std::vector<Table>& found) {
  FieldError error{profile_prefix + quantity};
  const Curve expected = curve(exact, {"plane_profile"}, quantity);
  const Curve phi = curve(exact, {"plane_profile"}, "phi");
  const Curve mine = curve(found, {"profile", "plane_profile"}, quantity);
  if (expected.position == nullptr) return error;
  const bool is_sum = quantity == "phi" || quantity == "density";
  double weights = 0, difference = 0, size = 0, largest = 0;
  for (std::size_t row = 0; row < expected.position->size(); ++row) {
    double distance = 0, square = 0;
    const auto my_row = mine.position == nullptr ? std::nullopt : row_at(*mine.position, (*expected.position)[row]);
    for (std::size_t c = 0; c < expected.components.size(); ++c) {
      const double r = (*expected.components[c])[row];
      const double f = my_row && c < mine.components.size() ? (*mine.components[c])[*my_row] : std::nan("");
      distance += (f - r) * (f - r);
      square += r * r;
    }
    if (std::isnan(square)) continue;
    if (std::isnan(distance)) {
      ++error.undefined;
      continue;
    }
    const double weight = is_sum ? 1 : (*phi.components.at(0))[row];
    ++error.points;
    weights += weight;
    difference += weight * distance;
    size += weight * square;
    largest = std::max(largest, distance);
  }
  if (difference > 0) {
    error.rms = std::sqrt(difference / size);
    error.largest = std::sqrt(largest * weights / size);
  }
  return error;
}

}  // namespace

std::vector<std::string> profile_quantities(const Pipeline& pipeline, const FrameSource& source) {
  const OptionValues* options = profile_options(pipeline);
  if (options == nullptr || !has_area(*options, source.frames().front().box)) return {};
  const OptionValues* of_voxels = options_of(pipeline, "profile");
  if (of_voxels != nullptr && (get<std::string>(*of_voxels, "geometry") != "planes" ||
                               get<double>(*of_voxels, "bin") > 0 || get<std::int64_t>(*of_voxels, "points") > 0))
    return {};
  Texts names;
  for (const std::string& name : of_both()) {
    const auto asked = [&](const Texts& fields) {
      return std::find(fields.begin(), fields.end(), name) != fields.end();
    };
    if (of_voxels == nullptr || asked(get<Texts>(*of_voxels, "fields"))) names.push_back(profile_prefix + name);
  }
  return names;
}

std::optional<Knob> profile_knob(const Pipeline& pipeline) {
  const OptionValues* of_voxels = options_of(pipeline, "profile");
  const OptionValues* exact = options_of(pipeline, "plane_profile");
  if ((of_voxels == nullptr) == (exact == nullptr)) return std::nullopt;
  if (of_voxels != nullptr) return Knob{"measure.profile", {"null"}, same_planes(*of_voxels, "plane_profile")};
  Knob knob{"measure.plane_profile", {"null"}, same_planes(*exact, "profile")};
  std::string fields;
  for (const std::string& name : of_both()) fields += (fields.empty() ? "" : ",") + name;
  knob.along.push_back("measure.profile.fields=[" + fields + ']');
  return knob;
}

Pipeline exact_profile(Pipeline pipeline) {
  OptionValues options;
  for (const OptionInfo& o : find_measurement("plane_profile")->options) options[o.name] = o.default_value;
  if (const OptionValues* own = profile_options(pipeline))
    for (auto& [name, value] : options)
      if (const auto it = own->find(name); it != own->end()) value = it->second;
  pipeline.measure = {{"plane_profile", std::move(options)}};
  pipeline.fields.clear();
  pipeline.trace.reset();
  return pipeline;
}

void require_same_axis(const Pipeline& a, const Pipeline& b) {
  const OptionValues *const of_a = profile_options(a), *const of_b = profile_options(b);
  if (of_a == nullptr || of_b == nullptr) return;
  const auto &axis_a = get<std::string>(*of_a, "axis"), &axis_b = get<std::string>(*of_b, "axis");
  if (axis_a == axis_b) return;
  throw ConfigError({b.location("measure"), "a profile along another axis is another quantity", axis_b, axis_a,
                     "tune compares profiles along the axis of the pipeline"});
}

std::vector<FieldError> profile_errors(const std::vector<std::string>& quantities, const std::vector<Table>& exact,
                                       const std::vector<Table>& found) {
  std::vector<FieldError> errors;
  for (const std::string& name : quantities)
    errors.push_back(error_of(name.substr(std::string(profile_prefix).size()), exact, found));
  return errors;
}

}  // namespace grainvdb
