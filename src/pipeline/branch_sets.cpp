#include "pipeline/branch_sets.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "bin/branches.hpp"

namespace grainvdb {
namespace {

constexpr std::uint8_t material_grain = 1;
constexpr std::uint8_t wall_grain = 2;

/// What the particle of each half branch is.
std::vector<std::uint8_t> roles_of_branches(const Frame& frame, const Pipeline& pipeline) {
  const Particles& p = frame.particles;
  std::vector<std::uint8_t> role(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (is_wall_grain(pipeline.walls, pipeline.select, frame.box, p, i)) {
      role[i] = wall_grain;
    } else if (is_selected(pipeline.select, frame.box, p, i)) {
      role[i] = material_grain;
    }
  }
  std::vector<std::uint8_t> of_branch;
  for (const std::size_t row : branch_particles(frame)) of_branch.push_back(role[row]);
  return of_branch;
}

void append(const HalfBranches& from, std::size_t n, HalfBranches& to) {
  for (std::size_t a = 0; a < 3; ++a) {
    to.start[a].push_back(from.start[a][n]);
    to.arm[a].push_back(from.arm[a][n]);
    to.force[a].push_back(from.force[a][n]);
  }
}

/// Contacts that keep both half branches first, so that these stay together.
HalfBranches outside_walls(const HalfBranches& all, const std::vector<std::uint8_t>& role) {
  HalfBranches kept;
  for (const bool both : {true, false})
    for (std::size_t n = 0; n < all.size(); ++n)
      if (role[n] != wall_grain && (role[n ^ 1U] != wall_grain) == both) append(all, n, kept);
  return kept;
}

HalfBranches at_walls(const HalfBranches& all, const std::vector<std::uint8_t>& role) {
  HalfBranches contacts;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (role[n] != material_grain || role[n ^ 1U] != wall_grain) continue;
    append(all, n, contacts);
    for (std::size_t a = 0; a < 3; ++a) {
      contacts.start[a].back() -= all.arm[a][n];
      contacts.arm[a].back() = 0;
    }
  }
  return contacts;
}

bool contains(const std::vector<int>& types, int type) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

}  // namespace

bool is_selected(const Selection& s, const Box& box, const Particles& p, std::size_t i) {
  if (!s.types.empty() && !contains(s.types, p.type[i])) return false;
  if (s.ids && (p.id[i] < s.ids->first || p.id[i] > s.ids->second)) return false;
  if (!s.region) return true;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const double x = box.wrap(a, p.position[axis][i]);
    if (x < s.region->first[axis] || x >= s.region->second[axis]) return false;
  }
  return true;
}

bool is_wall_grain(const WallSpec& walls, const Selection& selection, const Box& box, const Particles& p,
                   std::size_t i) {
  return walls.types.empty() ? !is_selected(selection, box, p, i) : contains(walls.types, p.type[i]);
}

BranchSets make_branch_sets(const Frame& frame, const Pipeline& pipeline, const std::set<BranchKind>& wanted) {
  BranchSets sets;
  for (const BranchKind set : wanted) sets[set];
  if (frame.contacts.size() == 0) return sets;
  HalfBranches all = half_branches(frame);
  if (wanted.contains(BranchKind::outside_walls) || wanted.contains(BranchKind::at_walls)) {
    const std::vector<std::uint8_t> role = roles_of_branches(frame, pipeline);
    if (wanted.contains(BranchKind::outside_walls)) sets[BranchKind::outside_walls] = outside_walls(all, role);
    if (wanted.contains(BranchKind::at_walls)) sets[BranchKind::at_walls] = at_walls(all, role);
  }
  if (wanted.contains(BranchKind::all)) sets[BranchKind::all] = std::move(all);
  return sets;
}

}  // namespace grainvdb
