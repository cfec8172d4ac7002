#include "support/compare.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "support/derived.hpp"

namespace grainvdb::testing {

Agreement compare(const FieldCopy& field, const VoxelBox& box, const std::vector<bool>& active,
                  const std::function<Uncertain(std::size_t, int)>& expected,
                  const std::function<double(std::size_t, int)>& magnitude) {
  Agreement a;
  for (std::size_t n = 0; n < box.size(); ++n) {
    if (!active[n]) continue;
    const Coord c = box.coord(n);
    for (int k = 0; k < field.meta.components; ++k) {
      const Uncertain want = expected(n, k);
      if (is_in_doubt(want)) {
        ++a.in_doubt;
        continue;
      }
      ++a.checked;
      const double found = static_cast<double>(field.at(c, k));
      bool good = std::isnan(found) == want.undefined();
      if (good && !want.undefined()) {
        const double error = std::abs(found - want.value);
        good = error <= want.error;
        if (const double size = magnitude(n, k); want.error < 1e-5 * size)
          a.worst_relative = std::max(a.worst_relative, error / size);
        if (want.error > 0) a.worst_of_bound = std::max(a.worst_of_bound, error / want.error);
      }
      if (good) continue;
      if (a.failures++ == 0) {
        std::ostringstream text;
        text.precision(9);
        text << "component " << k << " at voxel " << c.x << " " << c.y << " " << c.z << ": found " << found
             << ", expected " << want.value << " within " << want.error;
        a.first_failure = text.str();
      }
    }
  }
  return a;
}

std::size_t topology_differences(const Topology& topology, const VoxelBox& box, const std::vector<bool>& active) {
  std::size_t differences = 0;
  std::vector<bool> seen(box.size());
  for (std::size_t l = 0; l < topology.leaf_count(); ++l)
    topology.mask(l).for_each([&](int offset) {
      const Coord c = voxel_at(topology.origin(l), offset);
      const auto n = box.index(c);
      if (n && box.coord(*n) == c && active[*n]) {
        seen[*n] = true;
      } else {
        ++differences;
      }
    });
  for (std::size_t n = 0; n < box.size(); ++n)
    if (active[n] && !seen[n]) ++differences;
  return differences;
}

}  // namespace grainvdb::testing
