#pragma once
#include "support/memory_sink.hpp"

namespace grainvdb::testing {

/// Expects the same output times, fields and, where both have them, masks, to the last bit.
void expect_same_fields(const Record& a, const Record& b);
void expect_same_fields(const Written& a, const Written& b);

}  // namespace grainvdb::testing
