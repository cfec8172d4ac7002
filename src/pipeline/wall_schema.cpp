#include "pipeline/wall_schema.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace grainvdb {
namespace {

using Apply = std::function<void(Pipeline&, const ConfigValue&)>;

constexpr const char* in_dump_units = "Numbers are given without their unit, in the unit system of the dump.";

const std::vector<std::pair<std::string, WallSpec::Kernel>> kernels{{"cut", WallSpec::Kernel::cut},
                                                                    {"renormalise", WallSpec::Kernel::renormalise},
                                                                    {"mirror", WallSpec::Kernel::mirror},
                                                                    {"mask", WallSpec::Kernel::mask}};

void add_key(Schema& schema, KeyInfo key, Apply apply) {
  key.apply = std::move(apply);
  schema.keys.push_back(std::move(key));
}

KeyInfo vector_of_surface(const std::string& kind, const char* name, const char* unit, const char* help) {
  KeyInfo key{"walls.surfaces." + kind, name, ValueType::numbers, help, unit};
  key.fewest = key.most = 3;
  key.required = true;
  key.hint = in_dump_units;
  return key;
}

KeyInfo number_of_surface(const std::string& kind, const char* name, const char* unit, const char* help) {
  KeyInfo key{"walls.surfaces." + kind, name, ValueType::number, help, unit};
  key.minimum = 0;
  key.above_minimum = true;
  key.required = true;
  return key;
}

KeyInfo side_of_surface(const std::string& kind) {
  KeyInfo key{"walls.surfaces." + kind, "material", ValueType::text, "The side on which the material is."};
  key.choices = {"inside", "outside"};
  key.default_value = std::string("inside");
  return key;
}

std::vector<ItemKind> surface_kinds() {
  KeyInfo angle = number_of_surface("cone", "angle", "degrees", "Between the axis and the wall.");
  angle.maximum = 89.999;
  return {{"plane",
           "A plane.",
           {vector_of_surface("plane", "point", "length", "A point of the plane."),
            vector_of_surface("plane", "normal", "", "Points to the material; any length.")}},
          {"cylinder",
           "An endless cylinder.",
           {vector_of_surface("cylinder", "point", "length", "A point of the axis."),
            vector_of_surface("cylinder", "axis", "", "Direction of the axis; any length."),
            number_of_surface("cylinder", "radius", "length", "Radius."), side_of_surface("cylinder")}},
          {"cone",
           "An endless cone.",
           {vector_of_surface("cone", "apex", "length", "The tip."),
            vector_of_surface("cone", "axis", "", "Points from the tip into the cone; any length."), angle,
            side_of_surface("cone")}}};
}

Vec3 vector_in(const ConfigItem& item, const char* name) {
  const auto& v = std::get<std::vector<double>>(*item.find(name));
  return {v.at(0), v.at(1), v.at(2)};
}

double number_in(const ConfigItem& item, const char* name) {
  return std::get<double>(*item.find(name));
}

Wall wall_of(const ConfigItem& item) {
  if (item.kind == "plane") return {Wall::Shape::plane, vector_in(item, "point"), vector_in(item, "normal")};
  const bool encloses = std::get<std::string>(*item.find("material")) == "inside";
  if (item.kind == "cylinder")
    return {Wall::Shape::cylinder,
            vector_in(item, "point"),
            vector_in(item, "axis"),
            number_in(item, "radius"),
            0,
            encloses};
  const double angle = number_in(item, "angle") * std::numbers::pi / 180;
  return {Wall::Shape::cone, vector_in(item, "apex"), vector_in(item, "axis"), 0, angle, encloses};
}

std::vector<std::string> face_names() {
  std::vector<std::string> names;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) names.push_back(face_name({axis, high}));
  return names;
}

std::string surface_key(std::size_t n) {
  return "walls.surfaces[" + std::to_string(n) + ']';
}

void check_shapes(const Pipeline& p) {
  for (std::size_t n = 0; n < p.walls.surfaces.size(); ++n) {
    const Wall& wall = p.walls.surfaces[n];
    if (wall.direction == Vec3{0, 0, 0})
      throw ConfigError({p.location(surface_key(n)),
                         wall.shape == Wall::Shape::plane ? "the normal of a plane has length zero"
                                                          : "the axis of a wall has length zero",
                         "[0, 0, 0]",
                         "a direction",
                         {}});
  }
}

// Images of images in two planes are those that a grain has in any order only where the planes are perpendicular;
// between planes that face each other they go on and on, farther away each time.
void check_mirrors(const Pipeline& p) {
  const WallSpec& walls = p.walls;
  for (std::size_t n = 0; n < walls.surfaces.size(); ++n)
    if (walls.surfaces[n].shape != Wall::Shape::plane)
      throw ConfigError({p.location(surface_key(n)), "there are no mirror images behind a curved wall",
                         walls.surfaces[n].shape == Wall::Shape::cylinder ? "a cylinder" : "a cone",
                         "planes and faces of the box", "walls.kernel: renormalise takes every surface."});
  const std::vector<Vec3> normals = [&] {
    std::vector<Vec3> all;
    const WallDomain domain(walls.surfaces);
    for (const Wall& wall : domain.walls()) all.push_back(wall.direction);
    for (const BoxFace& face : walls.faces) all.push_back(inward_normal(face));
    return all;
  }();
  for (std::size_t i = 0; i < normals.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double cosine =
          normals[i][0] * normals[j][0] + normals[i][1] * normals[j][1] + normals[i][2] * normals[j][2];
      constexpr double rounding = 1e-9;
      if (std::abs(cosine) < rounding || cosine < -1 + rounding) continue;
      const std::string key = i < walls.surfaces.size() ? surface_key(i) : std::string("walls.box");
      if (cosine > 1 - rounding)
        throw ConfigError({p.location(key),
                           "two walls with mirror images face the same way",
                           {},
                           "one wall on each side",
                           "Leave one of them out."});
      throw ConfigError({p.location(key),
                         "mirror images behind two oblique planes do not agree",
                         {},
                         "planes that are perpendicular, or that face each other",
                         "walls.kernel: renormalise takes every surface."});
    }
}

}  // namespace

std::string face_name(const BoxFace& face) {
  return std::string(1, "xyz"[face.axis]) + (face.high ? "_hi" : "_lo");
}

void add_walls(Schema& schema) {
  schema.sections.push_back({"walls", "What bounds the material, and what is done about it."});
  KeyInfo kernel{"walls", "kernel", ValueType::text,
                 "What is done about the part of the kernel that walls cut off: 'cut' nothing; 'renormalise' divides "
                 "sums by the part of the kernel inside the walls; 'mirror' adds mirror images of grains and contacts "
                 "behind planes; 'mask' leaves voxels undefined whose kernel comes near a wall."};
  for (const auto& [name, mode] : kernels) kernel.choices.push_back(name);
  kernel.default_value = std::string("cut");
  add_key(schema, kernel, [](Pipeline& p, const ConfigValue& v) {
    for (const auto& [name, mode] : kernels)
      if (name == std::get<std::string>(v)) p.walls.kernel = mode;
  });
  KeyInfo surfaces{"walls", "surfaces", ValueType::items, "Walls by their shapes; material is on one side of each."};
  surfaces.kinds = surface_kinds();
  add_key(schema, surfaces, [](Pipeline& p, const ConfigValue& v) {
    for (const ConfigItem& item : std::get<std::vector<ConfigItem>>(v)) p.walls.surfaces.push_back(wall_of(item));
  });
  KeyInfo box{"walls", "box", ValueType::texts,
              "Faces of the simulation box that are walls; they must not be periodic "
              "and must not move."};
  box.choices = face_names();
  add_key(schema, box, [](Pipeline& p, const ConfigValue& v) {
    for (const std::string& name : std::get<std::vector<std::string>>(v))
      p.walls.faces.push_back({name[0] - 'x', name.ends_with("_hi")});
  });
  KeyInfo clearance{"walls", "clearance", ValueType::number,
                    "In mode mask, between the kernel's support and a wall; without it, 1.5 radii of the largest grain "
                    "of the first frame with material.",
                    "length"};
  clearance.minimum = 0;
  clearance.hint = in_dump_units;
  add_key(schema, clearance, [](Pipeline& p, const ConfigValue& v) { p.walls.clearance = std::get<double>(v); });
  KeyInfo types{"walls", "types", ValueType::integers,
                "Types of the wall grains; without it, wall grains are those that select leaves out."};
  types.minimum = 0;
  types.maximum = std::numeric_limits<int>::max();
  add_key(schema, types, [](Pipeline& p, const ConfigValue& v) {
    for (const std::int64_t type : std::get<std::vector<std::int64_t>>(v))
      p.walls.types.push_back(static_cast<int>(type));
  });
}

void check_walls(const Pipeline& p) {
  check_shapes(p);
  if (p.walls.kernel == WallSpec::Kernel::cut) return;
  if (p.walls.surfaces.empty() && p.walls.faces.empty())
    throw ConfigError({p.location("walls.kernel"),
                       "there is no wall for walls.kernel to act at",
                       {},
                       "walls.surfaces or walls.box",
                       {}});
  if (p.walls.kernel == WallSpec::Kernel::mirror) check_mirrors(p);
}

}  // namespace grainvdb
