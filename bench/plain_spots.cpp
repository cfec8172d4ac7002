#include "plain_spots.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace grainvdb::bench {
namespace {

constexpr double sinking_in_diameters = 1.8, exit_in_diameters = 0.5;

}  // namespace

PlainCells::PlainCells(const Box& box, const std::vector<Vec3>& positions, double edge) : box_(box) {
  for (int a = 0; a < 3; ++a) {
    count_[a] = std::max<std::size_t>(1, static_cast<std::size_t>(box.length(a) / edge));
    edge_[a] = box.length(a) / static_cast<double>(count_[a]);
  }
  cells_.resize(count_[0] * count_[1] * count_[2]);
  for (const Vec3& x : positions) {
    const std::size_t cell = cell_at(x);
    cells_[cell].push_back(cell_of_.size());
    cell_of_.push_back(cell);
  }
}

// Those beyond an end of the box belong to the last cell before it.
std::size_t PlainCells::cell_at(const Vec3& x) const {
  std::size_t cell = 0;
  for (int a = 0; a < 3; ++a) {
    const double u = (x[a] - box_.lo[a]) / edge_[a];
    cell = cell * count_[a] + std::min(count_[a] - 1, static_cast<std::size_t>(std::max(0.0, u)));
  }
  return cell;
}

void PlainCells::move(std::size_t i, const Vec3& x) {
  const std::size_t cell = cell_at(x);
  if (cell == cell_of_[i]) return;
  take_out(i);
  cells_[cell].push_back(i);
  cell_of_[i] = cell;
}

void PlainCells::take_out(std::size_t i) {
  std::vector<std::size_t>& cell = cells_[cell_of_[i]];
  *std::find(cell.begin(), cell.end(), i) = cell.back();
  cell.pop_back();
}

PlainSpots::PlainSpots(const spot::Container& container, Start start, const spot::SpotParameters& parameters,
                       std::uint64_t seed, double cell_edge)
    : container_(container),
      start_(std::move(start)),
      parameters_(parameters),
      random_(seed),
      cells_(container.box, start_.packing.position, cell_edge),
      here_(start_.packing.id.size(), 1),
      inside_(start_.packing.id.size(), 0) {
  next_ = draw();
}

PlainSpots::Event PlainSpots::draw() {
  const double rate = parameters_.insertion_rate + parameters_.hop_rate * static_cast<double>(spots().size());
  random_.exponential();  // the time, which nothing here depends on
  const double choice = random_.uniform() * rate - parameters_.insertion_rate;
  if (choice < 0 || spots().empty()) return {};
  Event event{false, std::min(static_cast<std::size_t>(choice / parameters_.hop_rate), spots().size() - 1), {}};
  const std::uint64_t bits = random_.bits();
  event.step = parameters_.step;
  for (std::size_t a = 0; a < 2; ++a) {
    if ((bits >> a & 1U) != 0) event.step[a] = -event.step[a];
    if (container_.box.periodic[a]) continue;
    const double x = spots()[event.spot][a];
    event.step[a] = std::clamp(x + event.step[a], container_.box.lo[a] + parameters_.wall_distance,
                               container_.box.hi[a] - parameters_.wall_distance) -
                    x;
  }
  return event;
}

void PlainSpots::run_events(std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const Event event = next_;
    if (event.entry)
      enter();
    else
      step(event);
  }
}

void PlainSpots::enter() {
  const spot::Orifice& hole = *container_.orifice;
  Vec3 spot{hole.centre[0], 0, container_.box.lo[2]};
  spot[0] += hole.width * (random_.uniform() - 0.5);
  spot[1] = random_.uniform(container_.box.lo[1], container_.box.hi[1]);
  start_.spots.push_back(spot);
  next_ = draw();
}

void PlainSpots::step(const Event& event) {
  Vec3& spot = start_.spots[event.spot];
  if (spot[2] >= start_.top) {
    spot = start_.spots.back();
    start_.spots.pop_back();
    next_ = draw();
    return;
  }
  Vec3 centre{};
  for (int a = 0; a < 3; ++a) {
    centre[a] = spot[a] + 0.5 * event.step[a];
    spot[a] = container_.box.wrap(a, spot[a] + event.step[a]);
  }
  next_ = draw();
  displace(centre, event.step);
}

Vec3 PlainSpots::difference(const Vec3& from, const Vec3& to) const {
  Vec3 d{};
  for (int a = 0; a < 3; ++a) {
    d[a] = container_.box.minimum_image(a, to[a] - from[a]);
  }
  return d;
}

std::vector<std::size_t> PlainSpots::within(const Vec3& centre, double radius) const {
  std::vector<std::size_t> found;
  cells_.visit(centre, radius, [&](std::size_t i) {
    const Vec3 d = difference(centre, positions()[i]);
    if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < radius * radius) found.push_back(i);
  });
  return found;
}

void PlainSpots::put(std::size_t i, Vec3 x) {
  const Box& box = container_.box;
  for (int a = 0; a < 3; ++a) {
    const double below = a == 2 ? sinking_in_diameters * start_.packing.diameter : 0;
    x[a] = box.periodic[a] ? box.wrap(a, x[a]) : std::clamp(x[a], box.lo[a] - below, box.hi[a]);
  }
  start_.packing.position[i] = x;
  cells_.move(i, x);
}

void PlainSpots::displace(const Vec3& centre, const Vec3& step) {
  const bool relaxed = parameters_.relaxation.every > 0;
  const std::vector<std::size_t> moved = within(centre, parameters_.radius);
  const std::vector<std::size_t> zone = relaxed ? within(centre, parameters_.relaxation.radius) : moved;
  for (const std::size_t i : moved) {
    Vec3 x = positions()[i];
    for (std::size_t a = 0; a < 3; ++a) x[a] -= step[a] / parameters_.influence;
    put(i, x);
  }
  if (relaxed) relax(zone);
  const double exit = container_.box.lo[2] - exit_in_diameters * start_.packing.diameter;
  for (const std::size_t i : zone) {
    if (positions()[i][2] >= exit) continue;
    cells_.take_out(i);
    here_[i] = 0;
  }
}

void PlainSpots::relax(const std::vector<std::size_t>& zone) {
  const double diameter = start_.packing.diameter;
  for (const std::size_t i : zone) inside_[i] = 1;
  std::vector<Vec3> pushes;
  for (const std::size_t i : zone) {
    const Vec3 x = positions()[i];
    Vec3 push = spot::push_from_walls(container_, x, diameter);
    cells_.visit(x, diameter, [&](std::size_t j) {
      const Vec3 d = difference(positions()[j], x);
      const double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      if (j == i || r2 >= diameter * diameter) return;
      const double f = (inside_[j] != 0 ? 0.5 : 1) * parameters_.relaxation.strength * (diameter / std::sqrt(r2) - 1);
      for (std::size_t a = 0; a < 3; ++a) push[a] += f * d[a];
    });
    pushes.push_back(push);
  }
  for (std::size_t k = 0; k < zone.size(); ++k) {
    Vec3 x = positions()[zone[k]];
    for (std::size_t a = 0; a < 3; ++a) x[a] += pushes[k][a];
    put(zone[k], x);
    inside_[zone[k]] = 0;
  }
}

}  // namespace grainvdb::bench
