#pragma once
/// Fields averaged over planes or shells, and over the output times.
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grainvdb/run.hpp"
#include "measure/bins.hpp"
#include "measure/flow_state.hpp"
#include "measure/time_sums.hpp"

namespace grainvdb {

/// φ of the grains that a field is a mean over by volume, so that its average is Σ φ q/Σ φ over voxels and times: "phi"
/// of velocity, angular_velocity, mean_diameter, temperature and rotational_fluctuation, "phi_small" of those of a
/// species. Every other is averaged as it stands: nothing.
std::string volume_weight(const std::string& field);

/// The fields that a FlowState is made of, beside rotational_fluctuation.
const std::vector<std::string>& flow_fields();

/// Averages over voxels (of a bin) and output times of the fields of a pipeline: Σ w q/Σ w, where w is the number of
/// frames of the output time, times φ where the field is a mean over volume. Vectors and tensors are rotated into the
/// directions of the bin first. A value that is NaN, which is how a field is masked, does not enter.
class FieldProfile {
 public:
  /// `fields` must be among those that take() is given, and so must be what weighs them (volume_weight).
  FieldProfile(const BinSpec& spec, const Lattice& lattice, std::vector<std::string> fields);

  void take(const OutputFields& output);

  std::size_t times() const { return sums_ ? sums_->times() : 0; }
  std::vector<std::int64_t> bins() const { return sums_ ? sums_->bins() : std::vector<std::int64_t>{}; }
  const Bins& geometry() const { return bins_; }
  /// Of a field, as it came; 1 before the first output time.
  int components(const std::string& field) const;

  /// The averages of one bin.
  class Means {
   public:
    Means(const FieldProfile& profile, std::int64_t bin, std::optional<std::size_t> without = {});
    double position() const;  ///< mean over the voxels
    double height() const;    ///< likewise
    double voxels() const;    ///< per output time, mean
    double value(const std::string& field, int component = 0) const;
    FlowState state() const;  ///< of what there is among the fields

   private:
    const FieldProfile& profile_;
    std::vector<double> sums_;
    double times_;
  };

  /// f of the averages of a bin, with its standard error over the output times.
  std::vector<Estimate> estimate(std::int64_t bin, std::size_t outputs,
                                 const std::function<void(const Means&, std::span<double>)>& f) const;

 private:
  struct Part {
    std::string name;
    std::string weight;  // volume_weight
    int components = 1;
    std::size_t first = 0;  // channel of the weight; the components follow
  };
  const Part* part(const std::string& field) const;
  void set_channels(const OutputFields& output);

  Bins bins_;
  std::vector<Part> parts_;
  std::optional<TimeSums> sums_;  // from the first output time on: before, the components are not known
};

}  // namespace grainvdb
