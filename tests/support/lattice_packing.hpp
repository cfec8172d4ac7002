#pragma once
/// Packings whose fields are known.
#include <functional>

#include "grainvdb/frame.hpp"

namespace grainvdb::testing {

/// A frame of particles of diameter 1 and mass 1 on the sites (i, j, k), 0 ≤ i, j, k < n, in the box [-½, n-½)³, with
/// the velocity that is asked for at each site.
Frame cubic_packing(int n, bool periodic, const std::function<Vec3(const Vec3& site)>& velocity);

/// A frame of one particle of diameter 1 at x in an open box around it.
Frame one_particle(const Vec3& x);

}  // namespace grainvdb::testing
