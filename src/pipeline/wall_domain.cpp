#include "pipeline/wall_domain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/branch_sets.hpp"
#include "pipeline/number.hpp"
#include "pipeline/unless_bad.hpp"
#include "pipeline/wall_schema.hpp"

namespace grainvdb {
namespace {

std::string vector_text(const Vec3& v) {
  return '(' + print_number(v[0]) + ", " + print_number(v[1]) + ", " + print_number(v[2]) + ')';
}

double face_of(const Box& box, const BoxFace& face) {
  const auto axis = static_cast<std::size_t>(face.axis);
  return face.high ? box.hi[axis] : box.lo[axis];
}

Wall wall_at(const Pipeline& pipeline, const BoxFace& face, const FrameSource& source,
             std::span<const std::size_t> wanted) {
  const FrameInfo& first = source.frames()[wanted.front()];
  const auto axis = static_cast<std::size_t>(face.axis);
  if (first.box.periodic[axis])
    throw ConfigError({pipeline.location("walls.box"), "a periodic face of the box is no wall", face_name(face),
                       "faces that are not periodic", "Give walls in a periodic box as walls.surfaces"});
  const double at = face_of(first.box, face);
  for (const std::size_t k : wanted) {
    const FrameInfo& frame = source.frames()[k];
    if (std::abs(face_of(frame.box, face) - at) <= 1e-6 * first.box.length(face.axis)) continue;
    throw ConfigError(
        {pipeline.location("walls.box"), "the face " + face_name(face) + " of the box moves",
         print_number(face_of(frame.box, face)) + " at step " + std::to_string(frame.step) + " of " + frame.file,
         print_number(at) + " as at step " + std::to_string(first.step),
         "Give walls that stand still as walls.surfaces"});
  }
  Wall wall{Wall::Shape::plane, first.box.lo, inward_normal(face)};
  wall.point[axis] = at;
  return wall;
}

// Where a wall lies does not repeat with the box, so that it must be the same at every image, or far from the boundary.
bool fits_period(const Wall& wall, const Box& box, int a, double cutoff) {
  const auto axis = static_cast<std::size_t>(a);
  constexpr double rounding = 1e-9;
  const double along = std::abs(wall.direction[axis]);
  if (wall.shape == Wall::Shape::plane) return along < rounding;
  if (wall.shape == Wall::Shape::cone) return false;
  if (along > 1 - rounding) return true;
  return along < rounding && wall.point[axis] - wall.radius >= box.lo[axis] + cutoff &&
         wall.point[axis] + wall.radius <= box.hi[axis] - cutoff;
}

void check_period(const Pipeline& pipeline, std::size_t n, const Wall& wall, const Box& box) {
  for (int a = 0; a < 3; ++a) {
    if (!box.periodic[static_cast<std::size_t>(a)] || fits_period(wall, box, a, pipeline.cutoff)) continue;
    const std::string axis(1, "xyz"[a]);
    throw ConfigError({pipeline.location("walls.surfaces[" + std::to_string(n) + ']'),
                       "a wall meets the periodic boundary along " + axis, to_string(wall),
                       wall.shape == Wall::Shape::plane ? "planes that are parallel to " + axis
                       : wall.shape == Wall::Shape::cylinder
                           ? "cylinders along " + axis + ", or that keep a cutoff away from the boundary"
                           : "cones only in boxes that are not periodic",
                       "Walls are not repeated with the box"});
  }
}

}  // namespace

WallDomain wall_domain(const Pipeline& pipeline, const FrameSource& source, std::span<const std::size_t> wanted) {
  std::vector<Wall> walls = WallDomain(pipeline.walls.surfaces).walls();
  const Box& box = source.frames()[wanted.front()].box;
  for (std::size_t n = 0; n < walls.size(); ++n) check_period(pipeline, n, walls[n], box);
  for (const BoxFace& face : pipeline.walls.faces) walls.push_back(wall_at(pipeline, face, source, wanted));
  return WallDomain(std::move(walls));
}

double wall_clearance(const Pipeline& pipeline, FrameSource& source, std::span<const std::size_t> wanted) {
  if (pipeline.walls.clearance) return *pipeline.walls.clearance;
  ColumnSet columns = Column::radius;
  if (!pipeline.select.types.empty()) columns |= Column::type;
  for (const std::size_t k : wanted) {
    const auto frame = read_unless_bad(pipeline.input, source, k, columns);
    if (!frame) continue;
    double largest = 0;
    for (std::size_t i = 0; i < frame->particles.size(); ++i)
      if (is_selected(pipeline.select, frame->box, frame->particles, i))
        largest = std::max(largest, frame->particles.radius[i]);
    if (largest > 0) return 1.5 * largest;
  }
  return 0;  // there is no material, which is refused elsewhere
}

std::string to_string(const Wall& wall) {
  const std::string side = wall.encloses ? "inside" : "outside";
  switch (wall.shape) {
    case Wall::Shape::plane:
      return "plane through " + vector_text(wall.point) + ", material towards " + vector_text(wall.direction);
    case Wall::Shape::cylinder:
      return "cylinder about " + vector_text(wall.point) + " along " + vector_text(wall.direction) + " of radius " +
             print_number(wall.radius) + ", material " + side;
    case Wall::Shape::cone:
      break;
  }
  return "cone from " + vector_text(wall.point) + " along " + vector_text(wall.direction) + " opening by " +
         print_number(wall.angle * 180 / std::numbers::pi) + " degrees, material " + side;
}

}  // namespace grainvdb
