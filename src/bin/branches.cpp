#include "bin/branches.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

// A contact point lies about one radius from the centre: a little less with overlap, more across a liquid bridge.
constexpr double longest_arm = 2;  // radii

std::string pair_name(const Contacts& contacts, std::size_t k) {
  return std::to_string(contacts.id1[k]) + " and " + std::to_string(contacts.id2[k]);
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

std::size_t particle_of(const Frame& frame, std::size_t contact, std::int64_t id) {
  const auto& ids = frame.particles.id;
  const auto it = std::lower_bound(ids.begin(), ids.end(), id);
  if (it == ids.end() || *it != id)
    fail(frame,
         "the contact between particles " + pair_name(frame.contacts, contact) +
             " names a particle that the frame lacks",
         "id " + std::to_string(id), "an id of the particle dump of this step",
         "The particle dump must hold every particle that has contacts, wall grains included; leave particles out with "
         "the pipeline's selection instead");
  return static_cast<std::size_t>(it - ids.begin());
}

Vec3 difference(const Box& box, const Columns3& a, std::size_t i, const Columns3& b, std::size_t j) {
  Vec3 d;
  for (int axis = 0; axis < 3; ++axis) d[axis] = box.minimum_image(axis, a[axis][i] - b[axis][j]);
  return d;
}

void check_arm(const Frame& frame, std::size_t contact, std::size_t particle, const Vec3& arm) {
  if (frame.particles.radius.empty()) return;
  const double length = std::sqrt(arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]);
  const double limit = longest_arm * frame.particles.radius[particle];
  if (length <= limit) return;
  std::ostringstream found, expected;
  found << "a distance of " << length << " from the centre of particle " << frame.particles.id[particle];
  expected << "at most " << limit << ", two radii";
  fail(frame, "the contact point of particles " + pair_name(frame.contacts, contact) + " lies far outside a particle",
       found.str(), expected.str(), "Check that the contact columns are named rightly and belong to the same step");
}

}  // namespace

HalfBranches half_branches(const Frame& frame) {
  const Contacts& contacts = frame.contacts;
  const Particles& particles = frame.particles;
  const bool has_points = !contacts.point[0].empty();
  if (contacts.size() > 0 && !has_points && particles.radius.empty())
    fail(frame, "the contacts have no contact point and the particles no radius", {}, "one or the other",
         "Give the radius of the grains in the pipeline file, or dump the contact points");

  HalfBranches branches;
  for (Columns3* columns : {&branches.start, &branches.arm, &branches.force})
    for (auto& column : *columns) column.reserve(2 * contacts.size());

  const auto add = [&](std::size_t contact, std::size_t particle, const Vec3& arm, double sign) {
    check_arm(frame, contact, particle, arm);
    for (int a = 0; a < 3; ++a) {
      branches.start[a].push_back(particles.position[a][particle]);
      branches.arm[a].push_back(arm[a]);
      branches.force[a].push_back(sign * contacts.force[a][contact]);
    }
  };

  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const std::size_t i = particle_of(frame, k, contacts.id1[k]);
    const std::size_t j = particle_of(frame, k, contacts.id2[k]);
    if (i == j)
      fail(frame, "a contact joins a particle with itself", "id " + std::to_string(contacts.id1[k]),
           "two different ids", {});
    Vec3 arm_i;
    Vec3 arm_j;
    if (has_points) {
      arm_i = difference(frame.box, particles.position, i, contacts.point, k);
      arm_j = difference(frame.box, particles.position, j, contacts.point, k);
    } else {
      const Vec3 l = difference(frame.box, particles.position, i, particles.position, j);
      const double share = particles.radius[i] / (particles.radius[i] + particles.radius[j]);
      for (int a = 0; a < 3; ++a) {
        arm_i[a] = share * l[a];
        arm_j[a] = (share - 1) * l[a];
      }
    }
    add(k, i, arm_i, 1);
    add(k, j, arm_j, -1);
  }
  return branches;
}

}  // namespace grainvdb
