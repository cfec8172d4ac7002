#pragma once
/// What must hold of every result, whatever the dumps were like.
#include <string>
#include <vector>

#include "support/run_in_memory.hpp"

namespace grainvdb::testing {

/// Says what is unsound about the fields of all output times; empty when nothing is:
/// - a NaN at an active voxel without a reason in the mask (one_sided_gradient is none: it leaves a value);
/// - a number where a reason applies that leaves this field undefined;
/// - a standard error that is undefined elsewhere than where its field is, or where the mask says few_blocks;
/// - an infinite number anywhere, a negative one where the field cannot be negative;
/// - a value other than the background at an inactive voxel of a leaf;
/// - fields that can be undefined without a mask; counts of reasons in the report that are not those of the mask.
std::vector<std::string> unsoundness(const Result& result);

}  // namespace grainvdb::testing
