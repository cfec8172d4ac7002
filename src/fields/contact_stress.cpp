#include <cstddef>

#include "fields/register.hpp"
#include "fields/voxels.hpp"

namespace grainvdb {
namespace {

/// The value of contact_stress.line_integral: `adaptive`, `exact`, `midpoint_curvature`, or `gauss1` … `gauss8`.
LineIntegral line_integral_of(const StageSettings& settings) {
  const auto& text = option<std::string>(settings, "contact_stress", "line_integral");
  if (text == "adaptive") return LineIntegral::adaptive();
  if (text == "exact") return LineIntegral::exact();
  if (text == "midpoint_curvature") return LineIntegral::midpoint_curvature();
  return LineIntegral::gauss(text.back() - '0');
}

BranchKind branch_kind_of(const StageSettings& settings) {
  const bool all = option<std::string>(settings, "contact_stress", "wall_contacts") == "include";
  return all ? BranchKind::all : BranchKind::outside_walls;
}

MomentPtr contact_stress_moment(const StageSettings& settings) {
  Moment m;
  m.name = "contact stress " + option<std::string>(settings, "contact_stress", "line_integral");
  m.branch_kind = branch_kind_of(settings);
  if (m.branch_kind == BranchKind::outside_walls) m.name += " outside walls";
  m.kind = Moment::Kind::contacts;
  m.channels = 9;
  m.columns = Column::contacts | Column::radius;
  m.line_integral = line_integral_of(settings);
  m.values = [set = m.branch_kind](const FrameView& view, std::span<double> q) {
    const HalfBranches& b = view.branches(set);
    for (std::size_t n = 0; n < b.size(); ++n)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) q[9 * n + 3 * i + j] = -b.force[i][n] * b.arm[j][n];
  };
  return std::make_shared<const Moment>(std::move(m));
}

}  // namespace

void register_contact_stress(StageRegistry& registry) {
  Stage s;
  s.name = "contact_stress";
  s.components = 9;
  s.dimension = dimension::stress;
  s.additive = true;
  s.of_forces = true;
  s.by_species = true;
  s.description = "contact stress, tension positive, row-major ij; every contact of the dump counts";
  s.equation = "-sum F_ab,i a_ab,j int_0^1 W(x - x_a + s a_ab) ds  (8)";
  std::vector<std::string> methods{"adaptive", "exact", "midpoint_curvature"};
  for (int n = 1; n <= 8; ++n) methods.push_back("gauss" + std::to_string(n));
  s.options = {
      {.name = "line_integral",
       .default_value = std::string("adaptive"),
       .help = "mean of W along a half branch: as few points as keep its error below 3e-5 W(0), closed form in double, "
               "one point with the second derivative of W on parts of c/5 at most (below 2e-3 W(0)), or n-point "
               "Gauss-Legendre (gauss1 ... gauss8; gauss1: below 1.3e-2 W(0) at c/6)",
       .choices = methods},
      {.name = "wall_contacts",
       .default_value = std::string("include"),
       .help = "include: forces on wall grains are spread to their centres too; exclude: without the half branches in "
               "wall grains, so that wall_force closes the balance of momentum",
       .choices = {"include", "exclude"}}};
  s.needs = [](const StageSettings& settings) { return StageNeeds{{}, {contact_stress_moment(settings)}}; };
  s.compute = [](const StageInput& in, SparseField& out) {
    write_moment(in, *contact_stress_moment(in.settings()), out);
  };
  registry.add(std::move(s));
}

}  // namespace grainvdb
