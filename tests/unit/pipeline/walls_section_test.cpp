/// The section `walls` of pipeline files.
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "unit/pipeline/support.hpp"

namespace grainvdb::walls_section_test {
namespace {

using test::load;
using test::minimal_text;
using test::refusal;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// The minimal file with lines added at its end, from line 10 on.
std::string plus(const std::string& lines) {
  return minimal_text() + lines;
}

TEST(WallsSection, DefaultsToTheKernelAsItIs) {
  const Pipeline p = load(minimal_text());
  EXPECT_EQ(p.walls.kernel, WallSpec::Kernel::cut);
  EXPECT_TRUE(p.walls.surfaces.empty());
  EXPECT_TRUE(p.walls.faces.empty());
  EXPECT_FALSE(p.walls.clearance.has_value());
}

TEST(WallsSection, TakesEveryShape) {
  const Pipeline p =
      load(plus("walls:\n"
                "  kernel: renormalise\n"
                "  types: [2, 3]\n"
                "  box: [z_lo, x_hi]\n"
                "  clearance: 0.5\n"
                "  surfaces:\n"
                "    - plane: {point: [1, 2, 3], normal: [0, 0, 2]}\n"
                "    - cylinder: {point: [0, 0, 0], axis: [0, 0, 1], radius: 4, material: outside}\n"
                "    - cone:\n"
                "        apex: [0, 0, -1]\n"
                "        axis: [0, 0, 1]\n"
                "        angle: 30\n"));
  EXPECT_EQ(p.walls.kernel, WallSpec::Kernel::renormalise);
  EXPECT_EQ(p.walls.types, (std::vector<int>{2, 3}));
  ASSERT_EQ(p.walls.faces.size(), 2U);
  EXPECT_EQ(p.walls.faces[0].axis, 2);
  EXPECT_FALSE(p.walls.faces[0].high);
  EXPECT_EQ(p.walls.faces[1].axis, 0);
  EXPECT_TRUE(p.walls.faces[1].high);
  EXPECT_EQ(p.walls.clearance, 0.5);
  ASSERT_EQ(p.walls.surfaces.size(), 3U);
  EXPECT_EQ(p.walls.surfaces[0], (Wall{Wall::Shape::plane, {1, 2, 3}, {0, 0, 2}}));
  EXPECT_EQ(p.walls.surfaces[1], (Wall{Wall::Shape::cylinder, {0, 0, 0}, {0, 0, 1}, 4, 0, false}));
  EXPECT_EQ(p.walls.surfaces[2].shape, Wall::Shape::cone);
  EXPECT_NEAR(p.walls.surfaces[2].angle, std::numbers::pi / 6, 1e-15);
  EXPECT_TRUE(p.walls.surfaces[2].encloses);
  // The resolved text says the same.
  const Pipeline again = load(p.resolved);
  EXPECT_EQ(again.walls.surfaces, p.walls.surfaces);
  EXPECT_EQ(again.resolved, p.resolved);
  EXPECT_EQ(p.location("walls.surfaces[1]").line, 17U);
}

TEST(WallsSection, TakesOverrides) {
  const Pipeline p =
      load(minimal_text(), {"walls.kernel=mirror", "walls.surfaces=[{plane: {point: [0, 0, 0], normal: [1, 0, 0]}}]"});
  EXPECT_EQ(p.walls.kernel, WallSpec::Kernel::mirror);
  EXPECT_EQ(p.walls.surfaces.size(), 1U);
}

TEST(WallsSection, RefusesWhatIsNoSurface) {
  const auto with = [&](const std::string& item) { return refusal(plus("walls:\n  surfaces:\n    - " + item + "\n")); };
  EXPECT_THAT(with("plan: {point: [0, 0, 0], normal: [0, 0, 1]}"),
              AllOf(StartsWith("FILE:12: unknown kind of item in walls.surfaces: 'plan'"),
                    HasSubstr("plane, cylinder or cone"), HasSubstr("Did you mean 'plane'?")));
  EXPECT_THAT(with("plane: {point: [0, 0, 0], normel: [0, 0, 1]}"),
              AllOf(StartsWith("FILE:12: unknown key of a plane in walls.surfaces: 'normel'"),
                    HasSubstr("Did you mean 'normal'?")));
  EXPECT_THAT(with("plane: {point: [0, 0, 0]}"),
              StartsWith("FILE:12: the key 'walls.surfaces.plane.normal' is missing"));
  EXPECT_THAT(with("plane: {point: [0, 0], normal: [0, 0, 1]}"),
              StartsWith("FILE:12: walls.surfaces.plane.point has the wrong number of items"));
  EXPECT_THAT(with("plane: {point: [0, 0, 0], normal: [0, 0, 0]}"),
              StartsWith("FILE:12: the normal of a plane has length zero"));
  EXPECT_THAT(with("cylinder: {point: [0, 0, 0], axis: [0, 0, 0], radius: 1}"),
              StartsWith("FILE:12: the axis of a wall has length zero"));
  EXPECT_THAT(with("cylinder: {point: [0, 0, 0], axis: [0, 0, 1], radius: 0}"),
              StartsWith("FILE:12: walls.surfaces.cylinder.radius is too small"));
  EXPECT_THAT(with("cone: {apex: [0, 0, 0], axis: [0, 0, 1], angle: 90}"),
              StartsWith("FILE:12: walls.surfaces.cone.angle is too large"));
  EXPECT_THAT(with("cone: {apex: [0, 0, 0], axis: [0, 0, 1], angle: 30, material: between}"),
              StartsWith("FILE:12: unknown name in walls.surfaces.cone.material"));
  EXPECT_THAT(with("plane"), AllOf(StartsWith("FILE:12: walls.surfaces has an item that is not one section"),
                                   HasSubstr("a list of plane: {point, normal}, cylinder: {point, axis, radius, "
                                             "material} or cone: {apex, axis, angle, material}")));
  EXPECT_THAT(with("plane:"), StartsWith("FILE:12: walls.surfaces has an item without keys"));
  EXPECT_THAT(refusal(plus("walls: {surfaces: []}\n")), StartsWith("FILE:10: walls.surfaces is an empty list"));
  EXPECT_THAT(refusal(plus("walls: {box: [w_lo]}\n")), StartsWith("FILE:10: unknown name in walls.box"));
  EXPECT_THAT(refusal(plus("walls: {kernel: mirrored}\n")), HasSubstr("Did you mean 'mirror'?"));
}

TEST(WallsSection, RefusesWhatDoesNotGoTogether) {
  EXPECT_THAT(refusal(plus("walls:\n  kernel: mask\n")), StartsWith("FILE:11: there is no wall for walls.kernel"));
  const auto mirror = [&](const std::string& items) {
    return refusal(plus("walls:\n  kernel: mirror\n  box: [x_lo]\n  surfaces:\n" + items));
  };
  const std::string below = "    - plane: {point: [0, 0, 0], normal: [0, 0, 1]}\n";
  EXPECT_THAT(mirror(below + "    - cylinder: {point: [0, 0, 0], axis: [0, 0, 1], radius: 1}\n"),
              AllOf(StartsWith("FILE:15: there are no mirror images behind a curved wall; found a cylinder"),
                    HasSubstr("renormalise takes every surface")));
  EXPECT_THAT(mirror(below + "    - plane: {point: [0, 0, 1], normal: [0, 0, 2]}\n"),
              StartsWith("FILE:15: two walls with mirror images face the same way"));
  EXPECT_THAT(mirror(below + "    - plane: {point: [0, 0, 1], normal: [0, 1, 1]}\n"),
              StartsWith("FILE:15: mirror images behind two oblique planes do not agree"));
  EXPECT_THAT(mirror("    - plane: {point: [0, 0, 1], normal: [1, 0, 1]}\n"),
              StartsWith("FILE:12: mirror images behind two oblique planes do not agree"));
}

TEST(WallsSection, HasASchemaForItems) {
  const auto json = nlohmann::json::parse(pipeline_schema(test::example_registry()));
  const auto items = json["properties"]["walls"]["properties"]["surfaces"]["items"]["anyOf"];
  ASSERT_EQ(items.size(), 3U);
  const auto cylinder = items[1]["properties"]["cylinder"];
  EXPECT_EQ(cylinder["properties"]["radius"]["exclusiveMinimum"], 0);
  EXPECT_EQ(cylinder["properties"]["material"]["default"], "inside");
  EXPECT_EQ(cylinder["required"], nlohmann::json::array({"point", "axis", "radius"}));
}

}  // namespace
}  // namespace grainvdb::walls_section_test
