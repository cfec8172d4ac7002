#include "naive_splat.hpp"

#include "lucy.hpp"

namespace grainvdb::bench {

Grids naive_splat(const Scene& scene, double h, std::span<const double> q, int channels) {
  const auto width = static_cast<std::size_t>(channels);
  Grids grids;
  std::vector<openvdb::FloatGrid::Accessor> accessors;
  for (std::size_t c = 0; c < width; ++c) {
    grids.push_back(openvdb::FloatGrid::create());
    grids.back()->setTransform(plain_transform(h));
    accessors.push_back(grids.back()->getAccessor());
  }
  for (std::size_t p = 0; p < scene.size(); ++p) {
    const double* values = q.data() + p * width;
    for_each_weight(scene.position[0][p] / h - 0.5, scene.position[1][p] / h - 0.5, scene.position[2][p] / h - 0.5,
                    cutoff, h, [&](int i, int j, int k, double w) {
                      const openvdb::Coord at(i, j, k);
                      for (std::size_t c = 0; c < width; ++c)
                        accessors[c].setValue(at, accessors[c].getValue(at) + static_cast<float>(w * values[c]));
                    });
  }
  return grids;
}

}  // namespace grainvdb::bench
