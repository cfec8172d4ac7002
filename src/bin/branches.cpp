#include "bin/branches.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "base/parallel.hpp"
#include "bin/particle_rows.hpp"
#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

// A contact point lies about one radius from the centre: a little less with overlap, more across a liquid bridge.
constexpr double longest_arm = 2;  // radii

std::string pair_name(const Contacts& contacts, std::size_t k) {
  return "particles " + std::to_string(contacts.id1[k]) + " and " + std::to_string(contacts.id2[k]);
}

[[noreturn]] void fail(const Frame& frame, const std::string& what, const std::string& found,
                       const std::string& expected, const std::string& hint) {
  Problem problem;
  problem.where.file = frame.file;
  problem.what = "step " + std::to_string(frame.step) + ": " + what;
  problem.found = found;
  problem.expected = expected;
  problem.hint = hint;
  throw InputError(problem);
}

/// `contact` says which one it is.
template <class Name>
std::size_t particle_of(const Frame& frame, const ParticleRows& rows, std::int64_t id, const Name& contact) {
  const std::size_t row = rows.find(id);
  if (row == ParticleRows::absent)
    fail(frame, "the contact " + contact() + " names a particle that the frame lacks", "id " + std::to_string(id),
         "an id of the particle dump of this step",
         "The particle dump must hold every particle that has contacts, wall grains included; leave particles out with "
         "the pipeline's selection instead");
  return row;
}

Vec3 difference(const Box& box, const Columns3& a, std::size_t i, const Columns3& b, std::size_t j) {
  Vec3 d;
  for (int axis = 0; axis < 3; ++axis) d[axis] = box.minimum_image(axis, a[axis][i] - b[axis][j]);
  return d;
}

/// `touching` says which particle or particles meet at the contact point.
template <class Name>
void check_arm(const Frame& frame, std::size_t particle, const Vec3& arm, const Name& touching) {
  if (frame.particles.radius.empty()) return;
  const double length = std::sqrt(arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]);
  const double limit = longest_arm * frame.particles.radius[particle];
  if (length <= limit) return;
  std::ostringstream found, expected;
  found << "a distance of " << length << " from the centre of particle " << frame.particles.id[particle];
  expected << "at most " << limit << ", two radii";
  fail(frame, "the contact point of " + touching() + " lies far outside a particle", found.str(), expected.str(),
       "Check that the contact columns are named rightly and belong to the same step");
}

/// Writes the two half branches of contact k to rows 2k and 2k+1.
void add_contact(const Frame& frame, const ParticleRows& rows, std::size_t k, HalfBranches& to) {
  const Contacts& contacts = frame.contacts;
  const Particles& particles = frame.particles;
  const auto pair = [&] { return pair_name(contacts, k); };
  const auto between = [&] { return "between " + pair(); };
  const std::size_t i = particle_of(frame, rows, contacts.id1[k], between);
  const std::size_t j = particle_of(frame, rows, contacts.id2[k], between);
  if (i == j)
    fail(frame, "a contact joins a particle with itself", "id " + std::to_string(contacts.id1[k]), "two different ids",
         {});
  Vec3 arm_i;
  Vec3 arm_j;
  if (!contacts.point[0].empty()) {
    arm_i = difference(frame.box, particles.position, i, contacts.point, k);
    arm_j = difference(frame.box, particles.position, j, contacts.point, k);
  } else {
    const Vec3 l = difference(frame.box, particles.position, i, particles.position, j);
    const double share = particles.radius[i] / (particles.radius[i] + particles.radius[j]);
    for (std::size_t a = 0; a < 3; ++a) {
      arm_i[a] = share * l[a];
      arm_j[a] = (share - 1) * l[a];
    }
  }
  const auto write = [&](std::size_t row, std::size_t particle, const Vec3& arm, double sign) {
    check_arm(frame, particle, arm, pair);
    for (std::size_t a = 0; a < 3; ++a) {
      to.start[a][row] = particles.position[a][particle];
      to.arm[a][row] = arm[a];
      to.force[a][row] = sign * contacts.force[a][k];
    }
  };
  write(2 * k, i, arm_i, 1);
  write(2 * k + 1, j, arm_j, -1);
}

}  // namespace

HalfBranches half_branches(const Frame& frame) {
  const Contacts& contacts = frame.contacts;
  if (contacts.size() > 0 && contacts.point[0].empty() && frame.particles.radius.empty())
    fail(frame, "the contacts have no contact point and the particles no radius", {}, "one or the other",
         "Give the radius of the grains in the pipeline file, or dump the contact points");

  HalfBranches branches;
  for (Columns3* columns : {&branches.start, &branches.arm, &branches.force})
    for (auto& column : *columns) column.resize(2 * contacts.size());
  const ParticleRows rows(frame.particles.id);
  // Of several contacts in error the first is reported, whichever thread meets its own first.
  std::atomic<std::size_t> first_wrong = contacts.size();
  parallel_ranges(contacts.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) try {
        add_contact(frame, rows, k, branches);
      } catch (const InputError&) {
        for (std::size_t before = first_wrong; k < before && !first_wrong.compare_exchange_weak(before, k);) continue;
        return;
      }
  });
  if (first_wrong < contacts.size()) add_contact(frame, rows, first_wrong, branches);
  return branches;
}

HalfBranches wall_half_branches(const Frame& frame) {
  const WallContacts& contacts = frame.wall_contacts;
  const ParticleRows rows(frame.particles.id);
  HalfBranches branches;
  branches.force = contacts.force;
  for (Columns3* columns : {&branches.start, &branches.arm})
    for (auto& column : *columns) column.resize(contacts.size());
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const auto particle_name = [&] { return "particle " + std::to_string(contacts.id[k]); };
    const std::size_t i = particle_of(frame, rows, contacts.id[k], [&] { return "of a wall with " + particle_name(); });
    const Vec3 arm = difference(frame.box, frame.particles.position, i, contacts.point, k);
    check_arm(frame, i, arm, [&] { return "a wall and " + particle_name(); });
    for (std::size_t a = 0; a < 3; ++a) {
      branches.start[a][k] = frame.particles.position[a][i];
      branches.arm[a][k] = arm[a];
    }
  }
  return branches;
}

std::vector<std::size_t> branch_particles(const Frame& frame) {
  const Contacts& contacts = frame.contacts;
  const ParticleRows rows(frame.particles.id);
  std::vector<std::size_t> particle(2 * contacts.size());
  parallel_for(contacts.size(), [&](std::size_t k) {
    particle[2 * k] = rows.find(contacts.id1[k]);
    particle[2 * k + 1] = rows.find(contacts.id2[k]);
  });
  return particle;
}

std::vector<std::size_t> wall_branch_particles(const Frame& frame) {
  const ParticleRows rows(frame.particles.id);
  std::vector<std::size_t> particle;
  for (const std::int64_t id : frame.wall_contacts.id) particle.push_back(rows.find(id));
  return particle;
}

}  // namespace grainvdb
