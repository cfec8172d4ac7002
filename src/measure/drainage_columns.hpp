#pragma once
/// The mean flow of a draining slot, over depth and time, at each place of the plane across the slot.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "grainvdb/measurement.hpp"
#include "measure/drainage_fit.hpp"

namespace grainvdb {

/// Of the option `origin`.
Origin origin_option(const OptionValues& options);

/// Sums over columns of voxels along the depth, of each output time, from the fields `phi` and `velocity`.
class DrainageColumns {
 public:
  explicit DrainageColumns(const MeasurementSetting& setting);

  /// The fields of one output time.
  void take(const OutputFields& fields);

  using TablesOf = std::function<std::vector<Table>(const std::vector<DrainagePoint>&)>;
  /// The tables of the mean flow. Voxels tell nothing of what all of them do for a time; what varies between output
  /// times does: from three on, the jackknife over them takes the place of an error that is smaller.
  std::vector<Table> tables(const TablesOf& tables_of) const;

  /// What says where the slot is and which part of the flow counts, in front of the others.
  static std::vector<OptionInfo> options(std::vector<OptionInfo> others);
  /// Refuses equal axes.
  static std::optional<OptionConflict> conflict(const OptionValues& options);

 private:
  using Place = std::pair<std::int32_t, std::int32_t>;  ///< up, across
  struct Column {
    double down = 0, across = 0, phi = 0;
    std::size_t voxels = 0;

    void add(const Column& other);
    void take_off(const Column& other);
  };
  using Columns = std::map<Place, Column>;

  Columns sum_over_times() const;
  std::vector<DrainagePoint> mean_flow(const Columns& sums, std::size_t outputs) const;
  void widen_errors(const Columns& all, const TablesOf& tables_of, std::vector<Table>& tables) const;

  Lattice lattice_;
  int up_, across_;
  double slot_, bottom_, lowest_, highest_, half_width_, least_phi_, independence_;
  std::vector<Columns> columns_;  ///< of each output time
};

}  // namespace grainvdb
