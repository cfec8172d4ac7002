#pragma once
/// Histories of a few tracers with known values.
#include <cmath>
#include <limits>
#include <vector>

#include "grainvdb/tracer_sink.hpp"
#include "unit/write/support.hpp"

namespace grainvdb::testing {

struct TracerScene {
  std::size_t tracers = 5;
  int samples = 3;
  bool optional_columns = true;  ///< strain, courant, gradient_number, stop_time
  std::vector<FieldMeta> fields{meta_of("phi", 1, 0.0F), meta_of("velocity", 3, nan_background),
                                meta_of("stress", 9, nan_background)};

  TracerLayout layout() const {
    TracerLayout l;
    for (std::size_t i = 0; i < tracers; ++i) l.id.push_back(10 + 7 * static_cast<std::int64_t>(i));
    l.box = {{-1, 0, 0.5}, {3, 0.1, 10.5}, {true, false, true}};
    l.fields = fields;
    l.length_unit = std::string("m");
    l.time_unit = std::string("s");
    l.time_meaning = std::string("time of the simulation");
    l.unit_system = "si";
    return l;
  }

  static double time(int t) { return 0.5 + 0.1 * t; }
  static std::int64_t step(int t) { return 1000 + 100 * t; }
  /// A number that tells quantity, component, tracer and sample apart, with all the digits of a double.
  static double number(int quantity, int component, std::size_t tracer, int t) {
    return std::sqrt(2.0 + 1000 * quantity + 100 * component + static_cast<double>(tracer) + 0.125 * t);
  }
  static float field_value(std::size_t field, int component, std::size_t tracer, int t) {
    if (field == 0 && tracer == 1 && t == 1) return nan_background;
    return static_cast<float>(-number(20 + static_cast<int>(field), component, tracer, t));
  }
  /// Tracer k stops with code k at the sample k.
  static TracerStop stop(std::size_t tracer, int t) {
    return tracer < 4 && t >= static_cast<int>(tracer) ? static_cast<TracerStop>(tracer) : TracerStop::moving;
  }
  static std::int32_t image(int axis, std::size_t tracer, int t) {
    return axis == 1 ? 0 : t * (axis - 1) * static_cast<std::int32_t>(tracer);
  }

  TracerSample sample(int t) const {
    TracerSample s;
    s.time = time(t);
    s.step = step(t);
    for (std::size_t i = 0; i < tracers; ++i) {
      for (int a = 0; a < 3; ++a) {
        s.position[static_cast<std::size_t>(a)].push_back(number(1, a, i, t));
        s.image[static_cast<std::size_t>(a)].push_back(image(a, i, t));
        s.displacement[static_cast<std::size_t>(a)].push_back(number(2, a, i, t));
      }
      s.stop.push_back(stop(i, t));
      if (!optional_columns) continue;
      s.strain.push_back(number(3, 0, i, t));
      s.courant.push_back(number(4, 0, i, t));
      s.gradient_number.push_back(number(5, 0, i, t));
      s.stop_time.push_back(stop(i, t) == TracerStop::moving ? std::numeric_limits<double>::quiet_NaN()
                                                             : time(static_cast<int>(i)));
    }
    for (std::size_t f = 0; f < fields.size(); ++f) {
      s.fields.emplace_back();
      for (std::size_t i = 0; i < tracers; ++i)
        for (int k = 0; k < fields[f].components; ++k) s.fields.back().push_back(field_value(f, k, i, t));
    }
    return s;
  }

  /// begin, and every write.
  void write_all(TracerSink& sink) const {
    sink.begin(layout());
    for (int t = 0; t < samples; ++t) sink.write(sample(t));
  }
};

inline std::unique_ptr<TracerSink> make_tracer_sink(const std::string& name, const std::string& folder) {
  for (const TracerSinkInfo& s : tracer_sink_registry())
    if (s.name == name) return s.make(folder);
  throw std::runtime_error("no tracer sink named " + name);
}

}  // namespace grainvdb::testing
