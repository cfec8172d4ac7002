#include "pipeline/branch_sets.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "bin/branches.hpp"

namespace grainvdb {
namespace {

constexpr std::uint8_t material_grain = 1;
constexpr std::uint8_t wall_grain = 2;

/// What each particle is.
std::vector<std::uint8_t> roles_of_particles(const Frame& frame, const Pipeline& pipeline) {
  const Particles& p = frame.particles;
  std::vector<std::uint8_t> role(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (is_wall_grain(pipeline.walls, pipeline.select, frame.box, p, i)) {
      role[i] = wall_grain;
    } else if (is_selected(pipeline.select, frame.box, p, i)) {
      role[i] = material_grain;
    }
  }
  return role;
}

/// What the particle of each half branch is.
template <class T>
std::vector<T> by_branch(std::span<const T> of_particle, const std::vector<std::size_t>& particle) {
  std::vector<T> of_branch;
  if (of_particle.empty()) return of_branch;
  of_branch.reserve(particle.size());
  for (const std::size_t row : particle) of_branch.push_back(of_particle[row]);
  return of_branch;
}

void append(const HalfBranches& from, std::size_t n, HalfBranches& to) {
  for (std::size_t a = 0; a < 3; ++a) {
    to.start[a].push_back(from.start[a][n]);
    to.arm[a].push_back(from.arm[a][n]);
    to.force[a].push_back(from.force[a][n]);
  }
  if (!from.species.empty()) to.species.push_back(from.species[n]);
}

/// Contacts that keep both half branches first, so that these stay together.
HalfBranches outside_walls(const HalfBranches& all, const std::vector<std::uint8_t>& role) {
  HalfBranches kept;
  for (const bool both : {true, false})
    for (std::size_t n = 0; n < all.size(); ++n)
      if (role[n] != wall_grain && (role[n ^ 1U] != wall_grain) == both) append(all, n, kept);
  return kept;
}

void move_to_contact_point(HalfBranches& branches, std::size_t n) {
  for (std::size_t a = 0; a < 3; ++a) {
    branches.start[a][n] -= branches.arm[a][n];
    branches.arm[a][n] = 0;
  }
}

HalfBranches at_walls(const HalfBranches& all, const std::vector<std::uint8_t>& role) {
  HalfBranches contacts;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (role[n] != material_grain || role[n ^ 1U] != wall_grain) continue;
    append(all, n, contacts);
    move_to_contact_point(contacts, contacts.size() - 1);
  }
  return contacts;
}

void add_contacts_of_grains(const Frame& frame, std::span<const std::uint8_t> role, BranchSets& sets) {
  const std::span<const int> species = frame.particles.species;
  HalfBranches all = half_branches(frame);
  std::vector<std::size_t> particle;
  if (!role.empty() || !species.empty()) particle = branch_particles(frame);
  all.species = by_branch(species, particle);
  if (!role.empty()) {
    const std::vector<std::uint8_t> of_branch = by_branch(role, particle);
    if (sets.contains(BranchKind::outside_walls)) sets[BranchKind::outside_walls] = outside_walls(all, of_branch);
    if (sets.contains(BranchKind::at_walls)) sets[BranchKind::at_walls] = at_walls(all, of_branch);
  }
  if (sets.contains(BranchKind::all)) sets[BranchKind::all] = std::move(all);
}

/// Behind those of contacts that have both half branches, so that these stay together.
void add_contacts_with_walls(const Frame& frame, std::span<const std::uint8_t> role, BranchSets& sets) {
  const std::span<const int> species = frame.particles.species;
  HalfBranches halves = wall_half_branches(frame);
  std::vector<std::size_t> particle;
  if (!role.empty() || !species.empty()) particle = wall_branch_particles(frame);
  halves.species = by_branch(species, particle);
  if (const auto all = sets.find(BranchKind::all); all != sets.end())
    for (std::size_t n = 0; n < halves.size(); ++n) append(halves, n, all->second);
  if (role.empty()) return;
  const std::vector<std::uint8_t> of_branch = by_branch(role, particle);
  if (const auto outside = sets.find(BranchKind::outside_walls); outside != sets.end())
    for (std::size_t n = 0; n < halves.size(); ++n)
      if (of_branch[n] != wall_grain) append(halves, n, outside->second);
  if (const auto at = sets.find(BranchKind::at_walls); at != sets.end())
    for (std::size_t n = 0; n < halves.size(); ++n) {
      if (of_branch[n] != material_grain) continue;
      append(halves, n, at->second);
      move_to_contact_point(at->second, at->second.size() - 1);
    }
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
  const bool contacts = frame.contacts.size() > 0, wall_contacts = frame.wall_contacts.size() > 0;
  if (!contacts && !wall_contacts) return sets;
  std::vector<std::uint8_t> role;
  if (wanted.contains(BranchKind::outside_walls) || wanted.contains(BranchKind::at_walls))
    role = roles_of_particles(frame, pipeline);
  if (contacts) add_contacts_of_grains(frame, role, sets);
  if (wall_contacts) add_contacts_with_walls(frame, role, sets);
  return sets;
}

}  // namespace grainvdb
