#pragma once
/// A measurement makes tables of the frames of a run, of its fields, or of both. It describes itself, as a stage does:
/// the registry alone feeds the pipeline file, the validation and the documentation. What it does not need is neither
/// read nor splatted.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/options.hpp"
#include "grainvdb/planes.hpp"
#include "grainvdb/stage.hpp"
#include "grainvdb/table.hpp"
#include "grainvdb/units.hpp"
#include "grainvdb/walls.hpp"

namespace grainvdb {

struct OutputFields;

/// Fields as exact averages over planes.
struct PlaneNeeds {
  Planes planes;
  std::vector<std::string> fields;
};

/// What a measurement must see.
struct MeasurementNeeds {
  std::optional<ColumnSet> particles{};  ///< of every frame, beside id and position; nothing: no frames
  std::vector<std::string> fields{};     ///< of every output time; none: no fields
  bool kernel = false;                   ///< the lattice and the kernel, where there are no fields
  /// In place of the fields of output times, their exact averages over planes: handed over likewise, on a column of
  /// voxels, one for each plane, whose indices along the normal are those of the lattice.
  std::optional<PlaneNeeds> planes{};
};

/// What is known before the first frame.
struct MeasurementSetting {
  const OptionValues& options;  ///< of the measurement, defaults filled in
  const StageSettings& stages;  ///< options of the fields
  const Lattice& lattice;       ///< this and the kernel mean nothing where neither they nor fields are needed
  LucyKernel kernel;
  Box box;                              ///< of the first frame [length]
  std::optional<double> grain_density;  ///< where the pipeline file says it [mass/length³]
  WallDomain walls{};                   ///< of the pipeline file
};

class Measurement {
 public:
  virtual ~Measurement() = default;
  /// A frame, in order of time: the particles that count as material, and all contacts where these are needed. Throws
  /// InputError for a frame that cannot be measured.
  virtual void add(const Frame&) {}
  /// The fields of one output time, in order of time.
  virtual void take(const OutputFields&) {}
  /// Once, after the last frame and output time.
  virtual std::vector<Table> tables() = 0;
};

struct MeasurementInfo {
  std::string name;         ///< of its section in the pipeline file
  std::string description;  ///< one line
  std::string equation;     ///< formula with its tag
  std::vector<OptionInfo> options{};
  std::string field_option{};  ///< the option that names fields, those of species among them; empty where none does
  /// Option values that are refused together; empty where none are.
  std::function<std::optional<OptionConflict>(const OptionValues&)> conflict{};
  std::function<MeasurementNeeds(const OptionValues&)> needs;
  std::function<std::unique_ptr<Measurement>(const MeasurementSetting&)> make;
};

/// The measurements that can be asked for.
const std::vector<MeasurementInfo>& measurement_registry();
/// nullptr when there is none of that name.
const MeasurementInfo* find_measurement(const std::string& name);

}  // namespace grainvdb
