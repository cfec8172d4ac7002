#pragma once
/// Options that measurements of spots share.
#include <optional>

#include "grainvdb/options.hpp"
#include "grainvdb/stage.hpp"
#include "measure/loosening.hpp"

namespace grainvdb {

/// `reference`, `flow_from` and `phi_at_rest`.
OptionInfo reference_option();
OptionInfo flow_from_option();
OptionInfo phi_at_rest_option();

/// The box `lo` to `hi`.
SmoothBox smooth_box(const OptionValues& options);
Loosening::Reference reference_of(const OptionValues& options);
/// Refuses options without a box.
std::optional<OptionConflict> whole_box_conflict(const OptionValues& options);

}  // namespace grainvdb
