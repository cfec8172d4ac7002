#pragma once
/// Quantities of the flow at many places: averaged over planes or shells, exactly over planes, or voxel by voxel.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grainvdb/measurement.hpp"
#include "grainvdb/run.hpp"
#include "measure/field_profile.hpp"

namespace grainvdb {

/// One place, and what was asked for there. Errors are NaN where there are none: for voxels, and for a profile of a
/// single output time.
struct StateSample {
  double position;  ///< along the normal of the planes, or from the axis of the shells [length]
  double height;    ///< along the axis [length]
  std::vector<Estimate> values;
};

/// Some numbers of a state.
using StateQuantities = std::function<void(const FlowState&, std::span<double>)>;

class StateSamples {
 public:
  virtual ~StateSamples() = default;
  virtual void take(const OutputFields& output) = 0;
  /// In ascending order of the bins, or as the voxels come. Places where the first of the values is undefined are left
  /// out.
  virtual std::vector<StateSample> samples() const = 0;
  /// The number of output times.
  virtual std::size_t times() const = 0;
};

/// bin_options(), `source`: profile, planes or voxels, the area of the planes, and the species whose grains are looked
/// at.
std::vector<OptionInfo> sample_options();
/// Refuses what bin_conflict does, and options that the source does not know.
std::optional<OptionConflict> sample_conflict(const OptionValues& options);

/// These fields, from the source that the options say.
MeasurementNeeds sample_needs(const OptionValues& options, std::vector<std::string> fields);

/// The area of the planes that exact averages are over, and what is needed for these fields.
OptionInfo plane_area_option();
PlaneNeeds plane_needs(const OptionValues& options, std::vector<std::string> fields);

/// The fields that samples by these options are made of, and more of all grains.
std::vector<std::string> sample_fields(const OptionValues& options, const std::vector<std::string>& more = {});

/// Samples as the options say, of these fields: sample_fields. Ratios are not formed where the fields of a voxel would
/// not be: up to pressure_floor, and up to gd_over_dv.temperature_min or the resolution of velocities.
std::unique_ptr<StateSamples> make_samples(const MeasurementSetting& setting, std::vector<std::string> fields,
                                           std::size_t quantities, StateQuantities f);

/// The errors to weigh value `index` of the samples by in a fit, √(s² + (floor y)²); empty, for equal weights, where
/// any is NaN or 0. The floor keeps an error that came out small by chance from deciding the fit.
std::vector<double> fit_errors(const std::vector<StateSample>& samples, std::size_t index, double floor);
/// The option of that floor.
OptionInfo error_floor_option();

}  // namespace grainvdb
