#include "bin/mirror.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/vec3.hpp"

namespace grainvdb {
namespace {

double distance(const Wall& plane, const Vec3& x) {
  return dot({x[0] - plane.point[0], x[1] - plane.point[1], x[2] - plane.point[2]}, plane.direction);
}

Vec3 at(const Columns3& columns, std::size_t n) {
  return {columns[0][n], columns[1][n], columns[2][n]};
}

/// Appends row n of `columns` less 2 `along` times the normal: a reflection where `along` is the part along it.
void append(Columns3& columns, std::size_t n, const Vec3& normal, double along, double sign) {
  for (std::size_t a = 0; a < 3; ++a) columns[a].push_back(sign * (columns[a][n] - 2 * along * normal[a]));
}
void append_vector(Columns3& columns, std::size_t n, const Vec3& normal) {
  if (!columns[0].empty()) append(columns, n, normal, dot(at(columns, n), normal), 1);
}
void append_pseudo_vector(Columns3& columns, std::size_t n, const Vec3& normal) {
  if (!columns[0].empty()) append(columns, n, normal, dot(at(columns, n), normal), -1);
}
template <class T>
void append_same(std::vector<T>& column, std::size_t n) {
  if (column.empty()) return;
  const T value = column[n];
  column.push_back(value);
}

void append_image(Particles& p, std::size_t n, const Wall& plane) {
  append(p.position, n, plane.direction, distance(plane, at(p.position, n)), 1);
  append_vector(p.velocity, n, plane.direction);
  append_pseudo_vector(p.angular_velocity, n, plane.direction);
  append_same(p.id, n);
  append_same(p.radius, n);
  append_same(p.mass, n);
  append_same(p.type, n);
  append_same(p.species, n);
}

void append_image(HalfBranches& b, std::size_t n, const Wall& plane) {
  append(b.start, n, plane.direction, distance(plane, at(b.start, n)), 1);
  append_vector(b.arm, n, plane.direction);
  append_vector(b.force, n, plane.direction);
  append_same(b.species, n);
}

double nearest_end(const Particles& p, std::size_t n, const Wall& plane) {
  return distance(plane, at(p.position, n));
}

double nearest_end(const HalfBranches& b, std::size_t n, const Wall& plane) {
  const double start = distance(plane, at(b.start, n));
  return std::min(start, start - dot(at(b.arm, n), plane.direction));
}

/// Images of all rows behind the planes of a group, then images of these behind the other plane, and so on.
template <class Rows>
void add_images_of_group(Rows& rows, const std::vector<Wall>& group, double depth) {
  constexpr std::size_t none = 2;
  std::vector<std::size_t> made_by(rows.size(), none);
  for (std::size_t n = 0; n < made_by.size(); ++n)
    for (std::size_t plane = 0; plane < group.size(); ++plane) {
      if (made_by[n] == plane || !(nearest_end(rows, n, group[plane]) < depth)) continue;
      append_image(rows, n, group[plane]);
      made_by.push_back(plane);
    }
}

}  // namespace

Mirror::Mirror(const std::vector<Wall>& planes, double depth) : depth_(depth) {
  for (const Wall& plane : planes) {
    const auto facing = std::find_if(groups_.begin(), groups_.end(), [&](const std::vector<Wall>& group) {
      return dot(group[0].direction, plane.direction) < -0.5;
    });
    if (facing == groups_.end()) {
      groups_.push_back({plane});
    } else {
      facing->push_back(plane);
    }
  }
}

void Mirror::add_images(Particles& p) const {
  for (const std::vector<Wall>& group : groups_) add_images_of_group(p, group, depth_);
}

void Mirror::add_images(HalfBranches& b) const {
  for (const std::vector<Wall>& group : groups_) add_images_of_group(b, group, depth_);
}

}  // namespace grainvdb
