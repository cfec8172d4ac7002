#include "spot/spot_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <hwy/cache_control.h>

namespace grainvdb::spot {
namespace {

// How far below the floor a particle can get before it is taken out; more than any step of the model moves it at once.
constexpr double sinking_in_diameters = 1.8;
constexpr double exit_in_diameters = 0.5;

// std::nearbyint of a number below 2^51, without a call.
double nearest(double x) {
  return (x + 0x1.8p52) - 0x1.8p52;
}

// The longest way of a particle at one step, in diameters.
double way_of_particle(const SpotParameters& p, double diameter) {
  const double influence = p.bias ? p.bias->fewest / p.bias->volume : p.influence;
  return std::hypot(p.step[0], p.step[1], p.step[2]) / influence / diameter;
}

double steps_per_relaxation(const Relaxation& relaxation) {
  return static_cast<double>(relaxation.every) / relaxation.probability;
}

// Lists that are kept must be renewed as grains go their ways, (way/skin)² times a step; to make them when they are
// wanted takes as long whatever happened in between. Measured with w = 399: the latter is faster from every 110th, 30th
// and 15th step on for steps of 0.7, 1.4 and 2 d.
ParticleStore::Neighbours neighbours_for(const SpotParameters& p, double diameter) {
  const Relaxation& relaxation = p.relaxation;
  if (relaxation.every == 0 || relaxation.probability == 0) return ParticleStore::Neighbours::none;
  const double between = steps_per_relaxation(relaxation), way = way_of_particle(p, diameter);
  return between > 1 && between * way * way > 6.4e-4 ? ParticleStore::Neighbours::listed_on_request
                                                     : ParticleStore::Neighbours::listed;
}

// Wider lists are renewed less often, and cost more at each relaxation. In diameters.
double skin_for(const SpotParameters& p, double diameter) {
  return std::clamp(49 * way_of_particle(p, diameter) * std::sqrt(steps_per_relaxation(p.relaxation)), 0.12, 0.5);
}

Floor floor_of(const Container& container, double diameter) {
  return container.orifice ? Floor{sinking_in_diameters * diameter, exit_in_diameters * diameter} : Floor{};
}

}  // namespace

SpotModel::SpotModel(const Container& container, const Packing& packing, const SpotParameters& parameters,
                     std::uint64_t seed)
    : container_(container),
      parameters_(parameters),
      particles_(container.box, packing, neighbours_for(parameters, packing.diameter),
                 floor_of(container, packing.diameter), skin_for(parameters, packing.diameter)),
      random_(seed) {
  for (std::size_t a = 0; a < 3; ++a) law_.unit[a] = static_cast<float>(particles_.unit()[a]);
  law_.diameter = static_cast<float>(packing.diameter);
  law_.strength = static_cast<float>(parameters.relaxation.strength);
  law_.mark = Site::in_zone;
  const Box& box = container.box;
  for (std::size_t k = 0; k < parameters.count; ++k) {
    const double x = random_.uniform(box.lo[0], box.hi[0]), y = random_.uniform(box.lo[1], box.hi[1]);
    spots_.push_back({x, y, random_.uniform(box.lo[2], box.hi[2])});
  }
  next_ = draw_event();
}

SpotModel::Event SpotModel::draw_event() {
  const double rate = parameters_.insertion_rate + parameters_.hop_rate * static_cast<double>(spots_.size());
  Event event;
  event.time = time_ + random_.exponential() / rate;
  const double choice = random_.uniform() * rate - parameters_.insertion_rate;
  if (choice < 0 || spots_.empty()) return event;
  const std::size_t k = std::min(static_cast<std::size_t>(choice / parameters_.hop_rate), spots_.size() - 1);
  event.spot = k;
  if (!parameters_.bias) event.step = draw_step();
  // It is one of many and will be needed in a moment.
  hwy::Prefetch(&spots_[k]);
  return event;
}

void SpotModel::advance(double end) {
  while (next_.time <= end) next_event();
  time_ = std::max(time_, end);
}

void SpotModel::run_events(std::uint64_t count) {
  for (std::uint64_t k = 0; k < count && std::isfinite(next_.time); ++k) next_event();
}

void SpotModel::next_event() {
  const Event event = next_;
  time_ = event.time;
  if (event.spot)
    step_spot(*event.spot, event.step);
  else
    insert_spot();
}

void SpotModel::insert_spot() {
  const Box& box = container_.box;
  const Orifice& hole = *container_.orifice;
  Vec3 spot{hole.centre[0], hole.centre[1], box.lo[2] - parameters_.entry_depth};
  const bool spread = parameters_.entry == SpotParameters::Entry::spread;
  const double room = room_over_orifice(container_, -parameters_.entry_depth, parameters_.floor_distance);
  const double half = std::min(0.5 * hole.width, room);
  if (hole.shape == Orifice::Shape::slot) {
    if (spread) spot[0] += 2 * half * (random_.uniform() - 0.5);
    spot[1] = random_.uniform(box.lo[1], box.hi[1]);
  } else if (spread) {
    const double r = half * std::sqrt(random_.uniform()), angle = 2 * std::numbers::pi * random_.uniform();
    spot[0] += r * std::cos(angle);
    spot[1] += r * std::sin(angle);
  }
  spots_.push_back(spot);
  ++counters_.inserted;
  next_ = draw_event();
}

Vec3 SpotModel::draw_step() {
  const std::uint64_t bits = random_.bits();
  Vec3 step = parameters_.step;
  if ((bits & 1U) != 0) step[0] = -step[0];
  if ((bits & 2U) != 0) step[1] = -step[1];
  if (parameters_.direction == SpotParameters::Direction::any && (bits & 4U) != 0) step[2] = -step[2];
  return step;
}

// The step, cut so that the spot keeps its distance from the floor and side walls.
Vec3 SpotModel::kept_inside(const Vec3& spot, Vec3 step) const {
  step = kept_off_plate(container_, spot, step, parameters_.floor_distance);
  const Box& box = container_.box;
  const int axes = parameters_.direction == SpotParameters::Direction::any ? 3 : 2;
  for (int a = 0; a < axes; ++a) {
    if (box.periodic[a]) continue;
    const double lo = box.lo[a] + parameters_.wall_distance, hi = box.hi[a] - parameters_.wall_distance;
    step[a] = std::clamp(spot[a] + step[a], std::min(lo, spot[a]), std::max(hi, spot[a])) - spot[a];
  }
  return step;
}

std::optional<Vec3> SpotModel::biased_step(const Vec3& spot) {
  std::array<Vec3, 4> candidates{};
  std::array<double, 4> weights{};
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    Vec3 step = parameters_.step;
    if ((k & 1U) != 0) step[0] = -step[0];
    if ((k & 2U) != 0) step[1] = -step[1];
    candidates[k] = kept_inside(spot, step);
    Vec3 end = spot;
    for (std::size_t a = 0; a < 3; ++a) end[a] += candidates[k][a];
    const std::size_t near = particles_.find(particles_.site_at(end), parameters_.radius).size();
    weights[k] = near == 0 ? 0 : std::pow(static_cast<double>(near), parameters_.bias->exponent);
    sum += weights[k];
  }
  if (sum == 0) return std::nullopt;
  double choice = random_.uniform() * sum;
  std::size_t k = 0;
  while (k < 3 && choice >= weights[k]) choice -= weights[k++];
  return candidates[k];
}

void SpotModel::remove_spot(std::size_t k) {
  spots_[k] = spots_.back();
  spots_.pop_back();
  ++counters_.removed;
  next_ = draw_event();
}

bool SpotModel::is_above_packing(const Vec3& spot) {
  const Box& box = container_.box;
  // Grains that hang in the orifice when all others have gone still meet spots.
  return !box.periodic[2] && spot[2] >= box.lo[2] + particles_.diameter() && !particles_.reaches(spot[2]);
}

void SpotModel::step_spot(std::size_t k, const Vec3& drawn) {
  Vec3& spot = spots_[k];
  if (is_above_packing(spot)) return remove_spot(k);
  const std::optional<Vec3> step = parameters_.bias ? biased_step(spot) : kept_inside(spot, drawn);
  if (!step) return remove_spot(k);
  const Vec3 centre = middle_of(spot, *step);
  for (int a = 0; a < 3; ++a) spot[a] = container_.box.wrap(a, spot[a] + (*step)[a]);
  ++counters_.steps;
  next_ = draw_event();
  displace(centre, *step);
}

Vec3 SpotModel::middle_of(const Vec3& spot, const Vec3& step) {
  return {spot[0] + 0.5 * step[0], spot[1] + 0.5 * step[1], spot[2] + 0.5 * step[2]};
}

// A displacement in counts. What is lost by rounding is made up for in later ones.
Site SpotModel::rounded(const Vec3& displacement) {
  Site site;
  for (std::size_t a = 0; a < 3; ++a) {
    rest_[a] += displacement[a] / particles_.unit()[a];
    const double whole = nearest(rest_[a]);
    site.at[a] = static_cast<std::int32_t>(whole);
    rest_[a] -= whole;
  }
  return site;
}

bool SpotModel::is_relaxed() {
  const Relaxation& relaxation = parameters_.relaxation;
  if (relaxation.every == 0 || counters_.steps % static_cast<std::uint64_t>(relaxation.every) != 0) return false;
  return relaxation.probability >= 1 || random_.uniform() < relaxation.probability;
}

double SpotModel::influence_at(const Site& centre) {
  if (!parameters_.bias) return parameters_.influence;
  const auto near = static_cast<double>(particles_.find(centre, parameters_.radius).size());
  return std::max(near, parameters_.bias->fewest) / parameters_.bias->volume;
}

void SpotModel::displace(const Vec3& centre, const Vec3& step) {
  const bool relaxed = is_relaxed();
  const Site site = particles_.site_at(centre);
  const double influence = influence_at(site);
  const Site displacement = rounded({-step[0] / influence, -step[1] / influence, -step[2] / influence});
  if (relaxed) {
    const Radii radii{parameters_.radius, parameters_.relaxation.radius};
    counters_.displaced += particles_.move_and_mark(site, radii, displacement);
    relax(centre);
  } else {
    counters_.displaced += particles_.move_within(site, parameters_.radius, displacement);
  }
  if (!particles_.has_left()) return;
  for (const std::int64_t id : particles_.take_left()) drained_.push_back({id, time_});
}

void SpotModel::relax(const Vec3& centre) {
  ++counters_.relaxed;
  particles_.list_zone();
  pushes_.resize(particles_.zone().size());
  push_apart(particles_.sites(), particles_.near(), particles_.zone(), law_, pushes_.data());
  push_off_walls(centre);
  particles_.move_zone(pushes_);
}

void SpotModel::push_off_walls(const Vec3& centre) {
  const Box& box = container_.box;
  const double reach = parameters_.relaxation.radius + 0.5 * particles_.diameter();
  bool near_wall = false;
  for (int a = 0; a < 3; ++a)
    near_wall |= !box.periodic[a] && (centre[a] - reach < box.lo[a] || (a < 2 && centre[a] + reach > box.hi[a]));
  if (!near_wall) return;
  const ParticleStore::Bounds inside = particles_.bounds(0.5 * particles_.diameter());
  for (std::size_t k = 0; k < pushes_.size(); ++k) {
    const std::int32_t i = particles_.zone()[k];
    if (inside.hold(particles_.site(i))) continue;
    const Vec3 push = push_from_walls(container_, particles_.position(i), particles_.diameter());
    for (std::size_t a = 0; a < 3; ++a)
      pushes_[k].at[a] += static_cast<std::int32_t>(std::nearbyint(push[a] / particles_.unit()[a]));
  }
}

}  // namespace grainvdb::spot
