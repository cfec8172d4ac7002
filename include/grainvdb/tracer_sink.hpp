#pragma once
/// Where the histories of tracers go. An output format is one class, one test and one line of registration.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "grainvdb/box.hpp"
#include "grainvdb/field_sink.hpp"
#include "grainvdb/frame.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

/// Why a tracer stands still. Its samples after that repeat the last good one.
enum class TracerStop : std::uint8_t {
  moving = 0,         ///< it does not
  left_material = 1,  ///< no kernel reaches the place it came to: a hole, or beyond a free surface
  left_domain = 2,    ///< it crossed an open side of the box
  masked = 3,         ///< a recorded field is undefined there, as the mask says
};
std::string_view name_of(TracerStop stop);

/// What is known before the first sample.
struct TracerLayout {
  std::vector<std::int64_t> id;   ///< of the tracers, ascending; those of the particles where they were seeded on some
  Box box;                        ///< of the simulation
  std::vector<FieldMeta> fields;  ///< recorded along the way, in this order
  std::string length_unit, time_unit;  ///< time_unit is "step" where the dump has no time
  std::string time_meaning;            ///< of the times of samples, e.g. "time of the simulation"
  std::string unit_system;             ///< as UnitSystem::name; "unspecified" where the dump names none
};

/// All tracers at one time. Every vector has one entry per tracer; undefined values are NaN.
struct TracerSample {
  double time = 0;
  std::int64_t step = 0;  ///< of the frame, or the number of the integration step in the time-mean field
  Columns3 position;      ///< wrapped into the box along its periodic axes [length]
  std::array<std::vector<std::int32_t>, 3> image;  ///< periods crossed: unwrapped = position + image × period
  std::vector<double> strain;                      ///< ∫|γ̇|dt since the start [1]; empty when not recorded
  Columns3 displacement;                           ///< from the seed, unwrapped [length]
  std::vector<double> courant;             ///< Co = |u|Δt/h of the step that led here [1]; empty when not recorded
  std::vector<double> gradient_number;     ///< K = |∇u|Δt of that step [1]; empty when not recorded
  std::vector<std::vector<float>> fields;  ///< per recorded field, [tracer][component]
  std::vector<TracerStop> stop;
  std::vector<double> stop_time;  ///< until when a tracer could be followed; NaN while it moves
};

/// begin, then write once per sample in order of time, then commit. Nothing appears under the final name before commit
/// has succeeded. Throws IoError or LimitError.
class TracerSink {
 public:
  virtual ~TracerSink() = default;
  virtual void begin(const TracerLayout& layout) = 0;
  virtual void write(const TracerSample& sample) = 0;
  virtual void commit(const Provenance& provenance) = 0;
  /// The files that commit leaves, for the user.
  virtual std::vector<std::string> files() const = 0;
};

struct TracerSinkInfo {
  std::string name;  ///< as in the pipeline file's trace.formats
  std::string description;
  std::unique_ptr<TracerSink> (*make)(const std::string& directory);
};
/// The formats that histories can be written in.
const std::vector<TracerSinkInfo>& tracer_sink_registry();

}  // namespace grainvdb
