#include "fields/voxels.hpp"

#include <limits>

namespace grainvdb {

void write_moment(const StageInput& in, const Moment& moment, SparseField& out) {
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    for (int c = 0; c < out.components(); ++c) {
      const double* from = in.moment(leaf, moment, c);
      float* to = out.leaf(leaf, c);
      in.topology().mask(leaf).for_each([&](int v) { to[v] = static_cast<float>(from[v]); });
    }
  });
}

void write_ratio(const StageInput& in, const Moment& numerator, const Moment& denominator, SparseField& out) {
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    const double* below = in.moment(leaf, denominator, 0);
    for (int c = 0; c < out.components(); ++c) {
      const double* above = in.moment(leaf, numerator, c);
      float* to = out.leaf(leaf, c);
      in.topology().mask(leaf).for_each([&](int v) {
        if (below[v] > 0) {
          to[v] = static_cast<float>(above[v] / below[v]);
        } else {
          to[v] = std::numeric_limits<float>::quiet_NaN();
          in.mask().add(leaf, v, Reason::no_material);
        }
      });
    }
  });
}

}  // namespace grainvdb
