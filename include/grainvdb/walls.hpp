#pragma once
/// Walls that bound the material: surfaces given by the user, since dumps do not tell of them.
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/box.hpp"
#include "grainvdb/kernel.hpp"

namespace grainvdb {

/// A surface with the material on one side.
struct Wall {
  enum class Shape {
    plane,     ///< through `point`, with the material on the side that `direction` points to
    cylinder,  ///< of `radius` about the line through `point` along `direction`
    cone       ///< of half opening `angle` with its apex in `point`, opening along `direction`
  };
  Shape shape = Shape::plane;
  Vec3 point{};          ///< [length]
  Vec3 direction{};      ///< any length > 0
  double radius = 0;     ///< > 0 [length]
  double angle = 0;      ///< between 0 and π/2 [rad]
  bool encloses = true;  ///< the material is inside a cylinder or cone; around it otherwise
  bool operator==(const Wall&) const = default;
};

/// The points y with normal·y ≥ offset.
struct HalfSpace {
  Vec3 normal{};      ///< of unit length
  double offset = 0;  ///< [length]
};

/// That on the material's side of the plane that touches a wall where it is nearest to x. It holds all of the material
/// at a plane and within a cylinder or a cone, and part of it around them. The direction of the wall must be of unit
/// length, as those of WallDomain are.
HalfSpace half_space_at(const Wall& wall, const Vec3& x);

/// A face of the simulation box as a wall: axis 0 … 2, at hi or lo.
struct BoxFace {
  int axis = 0;
  bool high = false;
};

/// The unit vector into the box.
Vec3 inward_normal(const BoxFace& face);

/// What the pipeline file says of walls.
struct WallSpec {
  /// What is done about the part of the kernel that a wall cuts off.
  enum class Kernel {
    cut,          ///< nothing: sums fall off towards the wall
    renormalise,  ///< sums are divided by the part of the kernel inside the material's domain
    mirror,       ///< particles and contacts have mirror images behind planes
    mask          ///< voxels whose kernel comes near a wall are masked
  };
  Kernel kernel = Kernel::cut;
  std::vector<Wall> surfaces;
  std::vector<BoxFace> faces;
  std::vector<int> types;           ///< particles that are wall grains; empty: those that are no material
  std::optional<double> clearance;  ///< between the kernel's support and a wall in mode mask; 1.5 r_max without it
};

/// The region that walls leave to the material: the points on the right side of all of them.
class WallDomain {
 public:
  WallDomain() = default;
  /// Directions need not be of unit length. Throws std::invalid_argument for a direction of length zero, a radius that
  /// is not positive, or an angle that is not between 0 and π/2.
  explicit WallDomain(std::vector<Wall> walls);

  const std::vector<Wall>& walls() const { return walls_; }  ///< with directions of unit length

  /// Distance to the nearest wall, negative on the wrong side of any; infinite without walls.
  double distance(const Vec3& x) const;
  bool contains(const Vec3& x) const { return distance(x) >= 0; }

  /// ∫ W(x - y) dV over the points y of the domain. Exact near one plane, or between two that face each other: ½ plus
  /// the integral of the marginal (physics section 2). Near other walls by a product rule over directions with the
  /// radial integral in closed form: the error is below 1e-4 within a cylinder wider than the kernel, and 4e-3 at
  /// worst, near the apex of a cone and around narrow columns.
  double inside_fraction(const LucyKernel& kernel, const Vec3& x) const;

 private:
  std::vector<Wall> walls_;
};

}  // namespace grainvdb
