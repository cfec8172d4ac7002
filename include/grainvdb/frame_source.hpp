#pragma once
/// Where frames come from: an index of what there is, and frames read on demand with the wanted columns only.
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "grainvdb/error.hpp"
#include "grainvdb/frame.hpp"
#include "grainvdb/half_step.hpp"
#include "grainvdb/units.hpp"

namespace grainvdb {

/// How the columns of contact dumps are found. Give `compute` or `columns`, not both.
struct ContactSpec {
  std::vector<std::string> files;  ///< paths, directories or globs; empty: no contacts
  /// Keywords of the LIGGGHTS `compute pair/gran/local` that made the dump (pos, vel, id, force, force_normal,
  /// force_tangential, torque, history, contactArea, delta, contactPoint, …), in any order; the dump's order is fixed.
  std::vector<std::string> compute;
  /// Or a map from id1, id2, force, normal_force, tangential_force, point to column names (one or three each).
  std::map<std::string, std::vector<std::string>> columns;
  std::optional<HalfStep> half_step;  ///< makes of the dumped forces those of the run; nothing leaves them
};

/// How the columns of dumps of contacts with walls that are no grains are found. Give `compute` or `columns`.
struct WallContactSpec {
  std::vector<std::string> files;  ///< paths, directories or globs; empty: no such contacts
  /// Keywords of the LIGGGHTS `compute wall/gran/local` that made the dump, in any order: pos, whose first half is the
  /// contact point; id; force, or force_normal and force_tangential; others.
  std::vector<std::string> compute;
  /// Or a map from id, force, normal_force, tangential_force, point and, to find contacts that come twice, mesh and
  /// triangle to column names (one or three each).
  std::map<std::string, std::vector<std::string>> columns;
};

/// What becomes of a frame that is malformed or lacks what is needed of it.
enum class OnError {
  error,      ///< it is an InputError
  skip_frame  ///< it is left out, and recorded
};

/// What the pipeline file says about the input. The places serve error messages.
struct InputSpec {
  std::vector<std::string> particles;  ///< paths, directories or globs of particle dumps
  ContactSpec contacts;
  WallContactSpec wall_contacts;
  std::optional<double> dt;             ///< time per step, for dumps without ITEM: TIME [time]
  std::optional<std::string> units;     ///< unit system, for dumps without ITEM: UNITS; must agree where both are given
  std::optional<double> density;        ///< of the grains, for dumps without mass: m = ρ 4/3 π r³ [mass/length³]
  std::optional<double> radius;         ///< of all grains, for dumps without radius and diameter [length]
  std::vector<std::string> columns;     ///< names of the particle columns, for binary dumps that do not name them
  std::optional<std::string> periodic;  ///< "none" or axes, such as "xy", for formats that do not say
  std::optional<Box> box;               ///< its bounds, for formats that do not say [length]
  OnError on_error = OnError::error;
  std::map<std::string, Location> where;  ///< where each key stands in the pipeline file, e.g. "input.dt"
};

/// One frame of the index.
struct FrameInfo {
  std::string file;
  std::size_t index_in_file = 0;
  std::int64_t step = 0;
  std::optional<double> time;
  std::size_t particle_count = 0;
  Box box;
};

/// What is left out of the input, and why.
struct BadFrame {
  std::string file;
  std::optional<std::int64_t> step;  ///< nothing where not even that can be read: the rest of the file
  std::string reason;                ///< what is wrong with it; several faults with "; " between them
};

/// "step 300: reason"; the reason alone, which names the file, where the step is not known.
std::string to_string(const BadFrame& frame);

/// What was done so far; shows that nothing unneeded was read.
struct ReadCounters {
  std::set<std::string> files_opened;
  std::set<std::string> columns_parsed;  ///< dump column names whose values were converted
  std::size_t frames_read = 0;
  std::size_t rows_read = 0;
  std::size_t bytes_read = 0;  ///< after decompression
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// All frames in ascending order of step.
  virtual const std::vector<FrameInfo>& frames() const = 0;
  /// Of the dumps or of InputSpec::units; where neither names any, a system called "unspecified" whose units are the
  /// names of the quantities.
  virtual const UnitSystem& units() const = 0;
  /// Names of the columns of the particle dumps, as in the first frame's header.
  virtual const std::vector<std::string>& particle_columns() const = 0;
  /// Names of the columns of the contact dumps; empty when there are none. Opens the first contact file.
  virtual std::vector<std::string> contact_columns() = 0;
  /// The same of the dumps of contacts with walls.
  virtual std::vector<std::string> wall_contact_columns() { return {}; }
  /// Every file of the input with its size in bytes, for the provenance.
  virtual std::vector<std::pair<std::string, std::uintmax_t>> files() const = 0;

  /// Throws InputError when frame k lacks a wanted column or wanted contacts, by the index alone.
  virtual void require(std::size_t k, ColumnSet wanted) = 0;
  /// Reads frame k of the index: id, position and the wanted columns. Throws InputError or IoError.
  virtual Frame read(std::size_t k, ColumnSet wanted) = 0;

  /// Where the index ends before the end of a file, because of a fault that OnError::skip_frame passes over.
  virtual std::vector<BadFrame> unreadable() const { return {}; }

  virtual const ReadCounters& counters() const = 0;
};

/// Finds the files, recognises their format and indexes the frames. Reads headers only where a file holds one frame.
/// Throws InputError (no frames, malformed headers, a step twice, units in conflict or unknown), IoError, or
/// ConfigError when the specification itself cannot be meant. With OnError::skip_frame files that are not recognised
/// and frames without a proper header are left out of the index, with what follows them in their file.
std::unique_ptr<FrameSource> open_dumps(const InputSpec& spec);

}  // namespace grainvdb
