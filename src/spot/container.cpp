#include "spot/container.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainvdb::spot {

std::optional<std::array<double, 2>> from_rim(const Container& container, const Vec3& x) {
  if (!container.orifice) return std::nullopt;
  const Orifice& hole = *container.orifice;
  const double half = 0.5 * hole.width;
  const double dx = container.box.minimum_image(0, x[0] - hole.centre[0]);
  if (hole.shape == Orifice::Shape::slot) {
    if (std::abs(dx) >= half) return std::nullopt;
    return std::array<double, 2>{dx - std::copysign(half, dx), 0};
  }
  const double dy = container.box.minimum_image(1, x[1] - hole.centre[1]);
  const double r = std::hypot(dx, dy);
  if (r >= half) return std::nullopt;
  if (r == 0) return std::array<double, 2>{-half, 0};
  return std::array<double, 2>{dx - half * dx / r, dy - half * dy / r};
}

double room_over_orifice(const Container& container, double height, double distance) {
  if (!container.orifice || std::abs(height) >= distance) return std::numeric_limits<double>::infinity();
  return std::max(0.0, 0.5 * container.orifice->width - std::sqrt(distance * distance - height * height));
}

Vec3 kept_off_plate(const Container& container, const Vec3& x, Vec3 step, double distance) {
  const double height = x[2] - container.box.lo[2], room = room_over_orifice(container, height + step[2], distance);
  if (!std::isfinite(room)) return step;
  const Orifice& hole = *container.orifice;
  const double dx = container.box.minimum_image(0, x[0] - hole.centre[0]);
  const bool slot = hole.shape == Orifice::Shape::slot;
  const double dy = slot ? 0 : container.box.minimum_image(1, x[1] - hole.centre[1]);
  const double rounding = 1e-9 * hole.width;
  if (std::hypot(dx, dy) > room_over_orifice(container, height, distance) + rounding) return step;
  const double end_x = dx + step[0], end_y = slot ? 0 : dy + step[1], r = std::hypot(end_x, end_y);
  if (r <= room) return step;
  step[0] = end_x * room / r - dx;
  if (!slot) step[1] = end_y * room / r - dy;
  return step;
}

Vec3 push_from_walls(const Container& container, const Vec3& x, double diameter) {
  const double radius = 0.5 * diameter;
  const Box& box = container.box;
  Vec3 push{};
  for (int a = 0; a < 2; ++a) {
    if (box.periodic[a]) continue;
    push[a] += std::max(0.0, box.lo[a] + radius - x[a]) - std::max(0.0, x[a] + radius - box.hi[a]);
  }
  if (box.periodic[2]) return push;
  const double height = x[2] - box.lo[2];
  if (std::abs(height) >= radius && !(height < 0 && !container.orifice)) return push;
  const auto rim = from_rim(container, x);
  if (!rim) {
    // The plate has two sides only where there is a hole to get to the lower one.
    const bool below = height < 0 && container.orifice;
    push[2] += below ? -(radius + height) : radius - height;
    return push;
  }
  const double distance = std::sqrt((*rim)[0] * (*rim)[0] + (*rim)[1] * (*rim)[1] + height * height);
  if (distance >= radius || distance == 0) return push;
  const double scale = (radius - distance) / distance;
  push[0] += scale * (*rim)[0];
  push[1] += scale * (*rim)[1];
  push[2] += scale * height;
  return push;
}

}  // namespace grainvdb::spot
