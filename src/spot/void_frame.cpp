#include "spot/void_frame.hpp"

#include <utility>

namespace grainvdb::spot {
namespace {

/// Where each id is; ids are 1 … the number of sites. The number of sites where a grain has left.
std::vector<std::size_t> sites_by_id(const LatticeVoids& model) {
  const std::vector<std::int64_t>& sites = model.sites();
  std::vector<std::size_t> result(sites.size() + 1, sites.size());
  for (std::size_t site = 0; site < sites.size(); ++site)
    if (sites[site] > LatticeVoids::empty) result[static_cast<std::size_t>(sites[site])] = site;
  return result;
}

}  // namespace

DumpFrame make_frame(const LatticeVoids& model, const Box& box, double diameter, const DumpFrame& before) {
  DumpFrame now{model.time(), box, diameter, {}, {}, {}};
  const std::vector<std::size_t> where = sites_by_id(model);
  const double dt = now.time - before.time;
  std::size_t k = 0;  // grains only leave: each was there before
  for (std::size_t id = 1; id < where.size(); ++id) {
    if (where[id] == model.sites().size()) continue;
    now.id.push_back(static_cast<std::int64_t>(id));
    now.position.push_back(model.lattice().position(where[id]));
    Vec3 velocity{};
    while (k < before.id.size() && before.id[k] < now.id.back()) ++k;
    if (k < before.id.size() && dt > 0)
      for (int a = 0; a < 3; ++a)
        velocity[a] = box.minimum_image(a, now.position.back()[a] - before.position[k][a]) / dt;
    now.velocity.push_back(velocity);
  }
  return now;
}

}  // namespace grainvdb::spot
