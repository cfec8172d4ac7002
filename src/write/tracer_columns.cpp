#include "write/tracer_columns.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

namespace grainvdb {
namespace {

void require(bool condition, const char* what) {
  if (!condition) throw std::invalid_argument(what);
}

}  // namespace

std::vector<TracerNumbers> numbers_of(const TracerSample& sample, const TracerLayout& layout) {
  std::vector<TracerNumbers> all;
  const Columns3& displacement = sample.displacement;
  all.push_back({"displacement",
                 layout.length_unit,
                 "displacement from the seed, across periodic boundaries",
                 "x(t) - x(0)",
                 {&displacement[0], &displacement[1], &displacement[2]}});
  const auto scalar = [&](const char* name, const char* description, const char* equation,
                          const std::vector<double>& values) {
    if (!values.empty()) all.push_back({name, "1", description, equation, {&values}});
  };
  scalar("strain", "shear strain accumulated since the start", "∫ |γ̇| dt along the path", sample.strain);
  scalar("courant", "Courant number of the step that led here", "Co = |u| Δt / h", sample.courant);
  scalar("gradient_number", "gradient number of the step that led here", "K = |∇u| Δt", sample.gradient_number);
  return all;
}

const std::vector<TracerStop>& tracer_stops() {
  static const std::vector<TracerStop> all{TracerStop::moving, TracerStop::left_material, TracerStop::left_domain,
                                           TracerStop::masked};
  return all;
}

TracerSampleCheck::TracerSampleCheck(const TracerLayout& layout) : tracers_(layout.id.size()) {
  require(tracers_ > 0, "an output of tracers needs at least one");
  for (const FieldMeta& f : layout.fields) field_sizes_.push_back(tracers_ * static_cast<std::size_t>(f.components));
}

void TracerSampleCheck::check(const TracerSample& sample) {
  const auto fits = [&](const auto& column) { return column.size() == tracers_; };
  const auto fits_if_given = [&](const auto& column) { return column.empty() || fits(column); };
  require(std::all_of(sample.position.begin(), sample.position.end(), fits) &&
              std::all_of(sample.image.begin(), sample.image.end(), fits) &&
              std::all_of(sample.displacement.begin(), sample.displacement.end(), fits) && fits(sample.stop) &&
              fits_if_given(sample.strain) && fits_if_given(sample.courant) && fits_if_given(sample.gradient_number) &&
              fits_if_given(sample.stop_time),
          "a sample has not one entry per tracer");
  require(std::equal(sample.fields.begin(), sample.fields.end(), field_sizes_.begin(), field_sizes_.end(),
                     [](const auto& values, std::size_t size) { return values.size() == size; }),
          "the recorded fields are not those that were announced");
  std::vector<std::string> names;
  for (const TracerNumbers& n : numbers_of(sample, {})) names.push_back(n.name);
  if (!sample.stop_time.empty()) names.emplace_back("stop_time");
  require(samples_ == 0 || (names == names_ && sample.time > last_time_), "a sample does not follow the one before");
  names_ = std::move(names);
  last_time_ = sample.time;
  ++samples_;
}

}  // namespace grainvdb
