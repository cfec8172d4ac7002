#include "spot/spot_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace grainvdb::spot {
namespace {

// How far below the floor a particle can get before it is taken out; more than any step of the model moves it at once.
constexpr double sinking_in_diameters = 1.8;
constexpr double exit_in_diameters = 0.5;

ParticleStore::Lists lists_for(const Relaxation& relaxation) {
  return relaxation.every > 0 && relaxation.probability > 0 ? ParticleStore::Lists::kept : ParticleStore::Lists::none;
}

double sinking(const Container& container, double diameter) {
  return container.orifice ? sinking_in_diameters * diameter : 0;
}

}  // namespace

SpotModel::SpotModel(const Container& container, const Packing& packing, const SpotParameters& parameters,
                     std::uint64_t seed)
    : container_(container),
      parameters_(parameters),
      particles_(container.box, packing, lists_for(parameters.relaxation), sinking(container, packing.diameter)),
      random_(seed) {
  for (std::size_t a = 0; a < 3; ++a) law_.unit[a] = static_cast<float>(particles_.unit()[a]);
  law_.diameter = static_cast<float>(packing.diameter);
  law_.strength = static_cast<float>(parameters.relaxation.strength);
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
  if (!parameters_.bias) event.step = kept_inside(spots_[k], draw_step());
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
    const Found& found = particles_.find(particles_.site_at(end), parameters_.radius, parameters_.radius);
    weights[k] =
        found.inner_count == 0 ? 0 : std::pow(static_cast<double>(found.inner_count), parameters_.bias->exponent);
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

void SpotModel::step_spot(std::size_t k, const Vec3& drawn) {
  Vec3& spot = spots_[k];
  // Grains that hang in the orifice when all others have gone still meet spots.
  const double top = std::max(particles_.top(), container_.box.lo[2] + particles_.diameter());
  if (!container_.box.periodic[2] && spot[2] >= top) return remove_spot(k);
  const std::optional<Vec3> step = parameters_.bias ? biased_step(spot) : drawn;
  if (!step) return remove_spot(k);
  Vec3 centre{};
  for (int a = 0; a < 3; ++a) {
    centre[a] = spot[a] + 0.5 * (*step)[a];
    spot[a] = container_.box.wrap(a, spot[a] + (*step)[a]);
  }
  ++counters_.steps;
  // Particles move now; what the event after this one will look at is fetched meanwhile.
  next_ = draw_event();
  prepare(next_);
  displace(centre, *step);
}

void SpotModel::prepare(const Event& event) const {
  if (!event.spot) return;
  Vec3 centre = spots_[*event.spot];
  for (std::size_t a = 0; a < 3; ++a) centre[a] += 0.5 * event.step[a];
  particles_.fetch(particles_.site_at(centre), parameters_.radius);
}

// A displacement in counts. What is lost by rounding is made up for in later ones.
Site SpotModel::rounded(const Vec3& displacement) {
  Site site;
  for (std::size_t a = 0; a < 3; ++a) {
    rest_[a] += displacement[a] / particles_.unit()[a];
    const double whole = std::nearbyint(rest_[a]);
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

void SpotModel::displace(const Vec3& centre, const Vec3& step) {
  const bool relaxed = is_relaxed();
  const double reach = relaxed ? parameters_.relaxation.radius : parameters_.radius;
  const Found& found = particles_.find(particles_.site_at(centre), parameters_.radius, reach);
  counters_.displaced += found.inner_count;
  double influence = parameters_.influence;
  if (parameters_.bias)
    influence = std::max(static_cast<double>(found.inner_count), parameters_.bias->fewest) / parameters_.bias->volume;
  const Site displacement = rounded({-step[0] / influence, -step[1] / influence, -step[2] / influence});
  const auto inner = std::span(found.inner).first(found.inner_count);
  const auto outer = std::span(found.outer).first(found.outer_count);
  zone_.assign(inner.begin(), inner.end());
  zone_.insert(zone_.end(), outer.begin(), outer.end());
  particles_.move_alike(inner, displacement);
  if (relaxed) relax(centre);
  drain(centre);
}

void SpotModel::relax(const Vec3& centre) {
  ++counters_.relaxed;
  if (law_.stamp == std::numeric_limits<std::int32_t>::max()) {
    for (std::size_t i = 0; i < particles_.slots(); ++i) particles_.set_stamp(static_cast<std::int32_t>(i), 0);
    law_.stamp = 0;
  }
  ++law_.stamp;
  for (const std::int32_t i : zone_) particles_.set_stamp(i, law_.stamp);
  pushes_.resize(zone_.size());
  push_apart(particles_.sites(), particles_.near(), zone_.data(), zone_.size(), law_, pushes_.data());
  push_off_walls(centre);
  particles_.move_each(zone_, pushes_);
}

void SpotModel::push_off_walls(const Vec3& centre) {
  const Box& box = container_.box;
  const double reach = parameters_.relaxation.radius + 0.5 * particles_.diameter();
  bool near_wall = false;
  for (int a = 0; a < 3; ++a)
    near_wall |= !box.periodic[a] && (centre[a] - reach < box.lo[a] || (a < 2 && centre[a] + reach > box.hi[a]));
  if (!near_wall) return;
  for (std::size_t k = 0; k < zone_.size(); ++k) {
    const Vec3 push = push_from_walls(container_, particles_.position(zone_[k]), particles_.diameter());
    for (std::size_t a = 0; a < 3; ++a)
      pushes_[k].at[a] += static_cast<std::int32_t>(std::nearbyint(push[a] / particles_.unit()[a]));
  }
}

void SpotModel::drain(const Vec3& centre) {
  if (!container_.orifice) return;
  const double exit = container_.box.lo[2] - exit_in_diameters * particles_.diameter();
  if (centre[2] - std::max(parameters_.radius, parameters_.relaxation.radius) > exit) return;
  for (const std::int32_t i : zone_) {
    if (particles_.position(i)[2] >= exit) continue;
    drained_.push_back({particles_.id(i), time_});
    particles_.take_out(i);
  }
}

}  // namespace grainvdb::spot
