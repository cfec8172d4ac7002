#pragma once
/// Where fields go. An output format is one class, one test and one line of registration.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/lattice.hpp"
#include "grainvdb/mask.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

/// What is known before the first field is written.
struct OutputLayout {
  explicit OutputLayout(const Lattice& l) : lattice(l) {}
  Lattice lattice;
  Coord first;  ///< the voxels that are written: first … last, inclusive
  Coord last;
  std::size_t time_count = 1;     ///< output times
  std::vector<FieldMeta> fields;  ///< in the order in which they are written
  bool has_mask = false;
  std::string length_unit, time_unit;  ///< of the axes; time_unit is "step" where the dump has no time
};

/// One output time: a frame, or the mean over a window of frames.
struct OutputTime {
  double time = 0;  ///< mean time of the frames [time_unit]
  std::int64_t first_step = 0;
  std::int64_t last_step = 0;
  std::size_t frame_count = 1;  ///< 0 where every frame was bad; time and steps are then those of these frames
};

/// Named texts that say where a result comes from: version, resolved pipeline, inputs, what was computed, …
using Provenance = std::vector<std::pair<std::string, std::string>>;

/// begin, then write once per output time, then commit. Nothing appears under the final name before commit has
/// succeeded; destroying a sink that was not committed removes what it wrote. Throws IoError or LimitError.
class FieldSink {
 public:
  virtual ~FieldSink() = default;
  virtual void begin(const OutputLayout& layout) = 0;
  virtual void write(const OutputTime& time, const std::vector<const SparseField*>& fields, const Mask* mask) = 0;
  virtual void commit(const Provenance& provenance) = 0;
  /// The files that commit leaves, for the user.
  virtual std::vector<std::string> files() const = 0;
};

struct SinkInfo {
  std::string name;  ///< as in the pipeline file's output.formats
  std::string description;
  std::unique_ptr<FieldSink> (*make)(const std::string& directory);
};
/// The formats that can be written.
const std::vector<SinkInfo>& sink_registry();

}  // namespace grainvdb
