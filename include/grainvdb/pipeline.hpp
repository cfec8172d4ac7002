#pragma once
/// A pipeline file, read and validated: what to read, on which lattice, how to average, and which fields to write.
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/accumulation.hpp"
#include "grainvdb/error.hpp"
#include "grainvdb/frame_source.hpp"
#include "grainvdb/options.hpp"
#include "grainvdb/planes.hpp"
#include "grainvdb/reduced_units.hpp"
#include "grainvdb/species.hpp"
#include "grainvdb/stage.hpp"
#include "grainvdb/trace_spec.hpp"
#include "grainvdb/walls.hpp"

namespace grainvdb {

/// What counts as material. A particle must satisfy every criterion that is given.
struct Selection {
  std::vector<int> types;                                    ///< empty: any
  std::optional<std::pair<std::int64_t, std::int64_t>> ids;  ///< inclusive range
  std::optional<std::pair<Vec3, Vec3>> region;  ///< lo ≤ x < hi per axis, on the wrapped position [length]
  bool empty() const { return types.empty() && !ids && !region; }
};

/// Frames start:stop:step of the sorted index, as Python slices: negative numbers count from the end.
struct FrameRange {
  std::optional<std::int64_t> start, stop;
  std::int64_t step = 1;  ///< > 0
};

/// The indices that a range selects out of n frames.
std::vector<std::size_t> select_frames(const FrameRange& range, std::size_t n);

/// Bounds that are checked before the work they bound begins.
struct Limits {
  std::int64_t extent = 1'000'000;            ///< voxels along any axis
  std::int64_t dense_voxels = 4'000'000'000;  ///< voxels of the written box
  double memory_gb = 0;                       ///< of moment sums; 0: three quarters of the machine's memory
  std::size_t frames_in_flight = 0;           ///< read but not yet summed; 0: chosen by the number of threads
  double volume_error = 0.05;                 ///< relative, of a grain's volume in the fields (grain_volume_error)
  double cutoff_in_diameters = 1.5;           ///< of a kernel that is wide enough not to show single grains
};

/// A standard error at which averaging ends.
struct Until {
  std::string field;      ///< whose error it is
  double error = 0;       ///< [unit of the field, or a part of its magnitude]
  bool relative = false;  ///< the latter
  double quantile = 0;    ///< the share of voxels in which the error must be no larger
};

/// A cutoff with its voxel.
struct Scale {
  double cutoff = 0;     ///< c of the kernel [length]
  double voxel = 0;      ///< h [length]
  std::string resolved;  ///< the pipeline at this scale, as Pipeline::resolved
};

struct Pipeline {
  std::string file;  ///< where it was read from
  InputSpec input;
  Selection select;
  std::vector<Species> species;  ///< of which there are partial fields; no grain may belong to two
  WallSpec walls;
  FrameRange frames;
  std::optional<std::pair<Vec3, Vec3>> region;  ///< where fields are wanted: voxel centres in lo ≤ x < hi [length]
  double voxel = 0;                             ///< h [length]
  Vec3 origin{};                                ///< of the lattice [length]
  double cutoff = 0;                            ///< c of the kernel [length]
  Accumulation accumulation = Accumulation::shifted;
  std::vector<Scale> scales;            ///< to run at, in place of cutoff and voxel; empty: at these
  std::size_t window = 0;               ///< frames per time average; 0: all frames in one
  std::size_t window_step = 0;          ///< frames from the beginning of one average to that of the next; 0: as window
  std::size_t blocks = 10;              ///< of frames, from whose differences standard errors are estimated
  std::optional<Until> until;           ///< ends the average before the last frame
  std::vector<std::string> fields;      ///< what to write, in this order
  StageSettings stages;                 ///< option values of every stage, defaults filled in
  std::vector<std::string> formats;     ///< of the output: hdf5, vdb
  std::optional<ReducedUnits> reduced;  ///< units of all that is written; without: those of the dump
  std::optional<TraceSpec> trace;       ///< histories of tracers, where they are wanted
  std::map<std::string, OptionValues> measure;  ///< the wanted measurements by name, with their options
  std::optional<Planes> planes;  ///< of which fields are exact averages, in place of values at voxels: as measured
  Limits limits;
  std::string resolved;                   ///< this pipeline as YAML with all defaults, for the provenance
  std::map<std::string, Location> where;  ///< where each key stands, e.g. "kernel.cutoff"; overrides stand at "--set"
  Location location(const std::string& key) const;  ///< of a key, or of the file when the key was not given
};

/// The key that wants the fields of the pipeline: output.fields, or measure where they are averages over planes.
std::string key_of_fields(const Pipeline& pipeline);

/// What must be computed: the fields that are written, then those that the tracers need.
std::vector<std::string> computed_fields(const Pipeline& pipeline);

/// Reads a pipeline file. `overrides` are "a.b=value" texts that win over the file. Relative input paths are taken
/// relative to the folder of the file. Throws ConfigError with file and line for anything that cannot be run as
/// written.
Pipeline load_pipeline(const std::string& file, const std::vector<std::string>& overrides = {},
                       const StageRegistry& registry = StageRegistry::standard());

/// The JSON schema of pipeline files, made from the same declarations that validate them.
std::string pipeline_schema(const StageRegistry& registry = StageRegistry::standard());

}  // namespace grainvdb
