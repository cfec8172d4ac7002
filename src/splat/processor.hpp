#pragma once
/// What the processor is, where the fastest way depends on it and the result does not.

namespace grainvdb {

/// Whether the processor works off registers of 512 bits in two halves. Smaller bricks, which waste fewer lanes, then
/// cost nothing.
bool halves_wide_registers();

}  // namespace grainvdb
