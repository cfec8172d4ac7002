#pragma once
/// When averaging may stop by itself: once a standard error has come down to what average.until asks for.
#include <cstddef>
#include <optional>
#include <string>

#include "average/window_sums.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/region.hpp"
#include "grainvdb/run.hpp"
#include "grainvdb/sparse_field.hpp"
#include "pipeline/derive_errors.hpp"

namespace grainvdb {

/// The standard error that the wanted share of voxels does not exceed, over the magnitude of the field where it is to
/// be relative. Vectors and tensors count by their magnitude, voxels of the region only, where there is one. Voxels
/// where the field is undefined do not count; where it has no error, the error is infinite. Infinite where no voxel
/// counts.
double error_of_share(const Until& until, const SparseField& field, const SparseField& error,
                      const std::optional<Region>& region);

/// The same in the midst of a sweep, from the blocks that there are.
double error_so_far(const DeriveSetting& setting, const WindowSums& sums, const std::optional<Region>& region);

/// Whether it is time to look, after so many frames: a block is full, and there are enough.
bool is_time_to_look(const Pipeline& pipeline, std::size_t frames);

/// How far it has come, for the progress.
std::string describe_progress(const Until& until, double error);
/// How it came out, for the report and the provenance.
std::string describe(const Until& until, const Stop& stop);

}  // namespace grainvdb
