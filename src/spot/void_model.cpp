#include "spot/void_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "grainvdb/error.hpp"

namespace grainvdb::spot {
namespace {

double distance_from_middle(const Container& container, const Vec3& x) {
  const Orifice& hole = *container.orifice;
  const double dx = container.box.minimum_image(0, x[0] - hole.centre[0]);
  if (hole.shape == Orifice::Shape::slot) return std::abs(dx);
  return std::hypot(dx, container.box.minimum_image(1, x[1] - hole.centre[1]));
}

}  // namespace

LatticeVoids::LatticeVoids(const Container& container, const StaggeredLattice& lattice,
                           const VoidParameters& parameters, std::uint64_t seed)
    : lattice_(lattice), parameters_(parameters), random_(seed), sites_(lattice.size()), grains_(lattice.size()) {
  std::iota(sites_.begin(), sites_.end(), std::int64_t{1});  // as lattice_packing numbers them
  choose_entries(container, parameters.entry);
  draw_time();
}

void LatticeVoids::choose_entries(const Container& container, VoidParameters::Entry entry) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t site = 0; container.orifice && site < lattice_.in_layer(0); ++site) {
    const Vec3 x = lattice_.position(site);
    if (!from_rim(container, x)) continue;
    entries_.push_back(site);
    nearest = std::min(nearest, distance_from_middle(container, x));
  }
  if (entries_.empty())
    throw ConfigError({{},
                       "voids have nowhere to enter",
                       {},
                       "an orifice below one of the sites of the lattice's lowest layer",
                       "Widen container.orifice or move it by a step of the lattice"});
  if (entry == VoidParameters::Entry::spread) return;
  const double rounding = 1e-9 * lattice_.step()[2];
  std::erase_if(entries_, [&](std::size_t site) {
    return distance_from_middle(container, lattice_.position(site)) > nearest + rounding;
  });
}

void LatticeVoids::draw_time() {
  const double hops = parameters_.hop_rate * static_cast<double>(voids_.size());
  next_ = time_ + random_.exponential() / (hops + parameters_.insertion_rate);
}

void LatticeVoids::advance(double end) {
  while (next_ <= end) next_event();
  time_ = std::max(time_, end);
}

void LatticeVoids::run_events(std::uint64_t count) {
  for (std::uint64_t k = 0; k < count; ++k) next_event();
}

void LatticeVoids::next_event() {
  time_ = next_;
  const double hops = parameters_.hop_rate * static_cast<double>(voids_.size());
  const double choice = random_.uniform() * (hops + parameters_.insertion_rate);
  if (choice < hops)
    hop(std::min(static_cast<std::size_t>(choice / parameters_.hop_rate), voids_.size() - 1));
  else
    insert_void();
  draw_time();
}

void LatticeVoids::insert_void() {
  const std::size_t site = entries_[random_.below(entries_.size())];
  if (sites_[site] <= empty) return;  // no grain is there to fall out
  drained_.push_back({sites_[site], time_});
  sites_[site] = empty;
  --grains_;
  voids_.push_back(site);
  ++counters_.inserted;
}

void LatticeVoids::hop(std::size_t k) {
  const std::size_t from = voids_[k];
  const StaggeredLattice::Neighbours above = lattice_.above(from);
  std::array<std::size_t, 4> grains{};
  std::size_t count = 0;
  bool waits = false;
  for (std::size_t n = 0; n < above.count; ++n) {
    const std::size_t site = above.site[n];
    if (sites_[site] > empty) grains[count++] = site;
    waits |= sites_[site] == empty;
  }
  if (count > 0) {
    const std::size_t to = grains[random_.below(count)];
    std::swap(sites_[from], sites_[to]);
    voids_[k] = to;
    ++counters_.hops;
  } else if (waits) {
    ++counters_.waits;
  } else {
    sites_[from] = air;
    voids_[k] = voids_.back();
    voids_.pop_back();
    ++counters_.removed;
  }
}

}  // namespace grainvdb::spot
