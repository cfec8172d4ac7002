#pragma once
/// The sections input.contacts and input.wall_contacts of a pipeline file, half_step apart.
#include "pipeline/schema.hpp"

namespace grainvdb {

void add_contact_keys(Schema& schema);

}  // namespace grainvdb
