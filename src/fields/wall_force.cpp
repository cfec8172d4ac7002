#include <cstddef>

#include "fields/register.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {
namespace {

MomentPtr wall_force_moment() {
  Moment m;
  m.name = "wall force";
  m.kind = Moment::Kind::contacts;
  m.channels = 3;
  m.columns = Column::contacts | Column::radius;
  m.branch_kind = BranchKind::at_walls;
  m.line_integral = LineIntegral::gauss(1);  // of arms of length zero: W itself
  m.values = [](const FrameView& view, std::span<double> q) {
    const HalfBranches& b = view.branches(BranchKind::at_walls);
    for (std::size_t n = 0; n < b.size(); ++n)
      for (std::size_t i = 0; i < 3; ++i) q[3 * n + i] = b.force[i][n];
  };
  return std::make_shared<const Moment>(std::move(m));
}

}  // namespace

void register_wall_force(StageRegistry& registry) {
  Stage s;
  s.name = "wall_force";
  s.components = 3;
  s.dimension = dimension::force_density;
  s.additive = true;
  s.of_forces = true;
  s.description = "force of walls on material, by volume, at the contact points";
  s.equation = "sum F_ab W(x - c_ab), a of the material and b in a wall";
  s.needs = [](const StageSettings&) { return StageNeeds{{}, {wall_force_moment()}}; };
  s.compute = [](const StageInput& in, SparseField& out) { write_moment(in, *wall_force_moment(), out); };
  registry.add(std::move(s));
}

}  // namespace grainvdb
