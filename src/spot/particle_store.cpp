#include "spot/particle_store.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace grainvdb::spot {
namespace {

constexpr double skin_in_diameters = 0.3;
// Beyond walls there is room for the grains that are pushed there, and for those that fall through the floor.
constexpr double margin_in_diameters = 2;
constexpr double cell_in_diameters = 2;
// Differences wrap at 2³² counts: a period is as long as that. Along other axes none exceeds 2³¹.
constexpr double period_counts = 0x1p32, open_counts = 0x1p31;

std::uint32_t as_unsigned(std::int32_t counts) {
  return static_cast<std::uint32_t>(counts);
}

}  // namespace

ParticleStore::ParticleStore(const Box& box, const Packing& packing, Lists lists, double below_floor)
    : box_(box), diameter_(packing.diameter), lists_(lists), skin_(skin_in_diameters * packing.diameter) {
  set_scales(below_floor);
  size_ = packing.id.size();
  id_ = packing.id;
  sites_.reserve(size_);
  for (const Vec3& x : packing.position) {
    Site site = site_at(x);
    for (std::size_t a = 0; a < 3; ++a) site.at[a] = std::clamp(site.at[a], limits_.lowest[a], limits_.highest[a]);
    sites_.push_back(site);
  }
  cell_of_.assign(size_, 0);
  make_cells();
  compact();
}

void ParticleStore::set_scales(double below_floor) {
  // A third of the skin, most of it along z, where particles drift.
  const double third = skin_ / 3;
  const Vec3 share{0.37, 0.37, 0.85};
  for (std::size_t a = 0; a < 3; ++a) {
    const bool periodic = box_.periodic[a];
    const double margin = periodic ? 0 : margin_in_diameters * diameter_;
    const double length = box_.length(static_cast<int>(a)) + 2 * margin;
    const double range = periodic ? period_counts : open_counts;
    origin_[a] = box_.lo[a] - margin;
    unit_[a] = length / range;
    cells_.cells[a] = std::max(1, static_cast<int>(length / (cell_in_diameters * diameter_)));
    cells_.per_cell[a] = range / cells_.cells[a];
    cells_.edge[a] = length / cells_.cells[a];
    cells_.unit[a] = static_cast<float>(unit_[a]);
    cells_.periodic[a] = periodic;
    limits_.trigger[a] = static_cast<std::int32_t>(share[a] * third / unit_[a]);
    limits_.lowest[a] = std::numeric_limits<std::int32_t>::min();
    limits_.highest[a] = std::numeric_limits<std::int32_t>::max();
    if (periodic) continue;
    const double below = a == 2 ? below_floor : 0;
    limits_.lowest[a] = static_cast<std::int32_t>((margin - below) / unit_[a]);
    limits_.highest[a] = static_cast<std::int32_t>((length - margin) / unit_[a]);
  }
  cells_.slack = third;
  limits_.lowest[3] = std::numeric_limits<std::int32_t>::min();  // stamps are left alone
  limits_.highest[3] = limits_.trigger[3] = std::numeric_limits<std::int32_t>::max();
}

Vec3 ParticleStore::position_of(const Site& site) const {
  Vec3 x{};
  for (std::size_t a = 0; a < 3; ++a) x[a] = origin_[a] + as_unsigned(site.at[a]) * unit_[a];
  return x;
}

Site ParticleStore::site_at(const Vec3& x) const {
  Site site;
  for (std::size_t a = 0; a < 3; ++a) {
    const double counts = std::floor((box_.wrap(static_cast<int>(a), x[a]) - origin_[a]) / unit_[a]);
    const double last = (box_.periodic[a] ? period_counts : open_counts) - 1;
    site.at[a] = static_cast<std::int32_t>(static_cast<std::uint32_t>(std::clamp(counts, 0.0, last)));
  }
  return site;
}

double ParticleStore::top() {
  while (layers_in_use_ > 0 && layer_counts_[layers_in_use_ - 1] == 0) --layers_in_use_;
  return layers_in_use_ == 0 ? box_.lo[2] : origin_[2] + static_cast<double>(layers_in_use_) * cells_.edge[2];
}

const Found& ParticleStore::find(const Site& centre, double inner, double outer) {
  find_within(cells_, centre.at, inner, outer, found_);
  return found_;
}

void ParticleStore::move_alike(std::span<const std::int32_t> indices, const Site& displacement) {
  renew(move_sites(sites_.data(), listed_at_.data(), indices.data(), indices.size(), &displacement, 0, limits_,
                   renewed_.data()));
}

void ParticleStore::move_each(std::span<const std::int32_t> indices, std::span<const Site> displacements) {
  renew(move_sites(sites_.data(), listed_at_.data(), indices.data(), indices.size(), displacements.data(), 1, limits_,
                   renewed_.data()));
}

void ParticleStore::take_out(std::int32_t i) {
  take_from_cell(i);
  if (lists_ == Lists::kept) forget_neighbours(i);
  cell_of_[static_cast<std::size_t>(i)] = -1;
  --size_;
}

void ParticleStore::compact() {
  std::vector<std::int32_t> order;
  order.reserve(size_);
  for (std::size_t i = 0; i < id_.size(); ++i) {
    if (cell_of_[i] < 0) continue;
    cell_of_[i] = static_cast<std::int32_t>(cell_at(sites_[i]));
    order.push_back(static_cast<std::int32_t>(i));
  }
  const auto key = [&](std::int32_t i) {
    return std::pair(cell_of_[static_cast<std::size_t>(i)], id_[static_cast<std::size_t>(i)]);
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) { return key(i) < key(j); });
  std::vector<std::int64_t> id;
  std::vector<Site> sites;
  id.reserve(size_);
  sites.reserve(size_);
  for (const std::int32_t i : order) {
    id.push_back(id_[static_cast<std::size_t>(i)]);
    sites.push_back(sites_[static_cast<std::size_t>(i)]);
  }
  id_ = std::move(id);
  sites_ = std::move(sites);
  index_all();
}

std::size_t ParticleStore::cell_at(const Site& site) const {
  std::size_t cell = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto n = static_cast<std::uint64_t>(cells_.cells[a]);
    cell = cell * n + (as_unsigned(site.at[a]) * n >> (cells_.periodic[a] ? 32U : 31U));
  }
  return cell;
}

void ParticleStore::make_cells() {
  const std::size_t cells = static_cast<std::size_t>(cells_.cells[0]) * static_cast<std::size_t>(cells_.cells[1]) *
                            static_cast<std::size_t>(cells_.cells[2]);
  if (cells_.capacity == 0) cells_.capacity = 16;
  members_.assign(cells * cells_.capacity, 0);
  counts_.assign(cells, 0);
  layer_counts_.assign(static_cast<std::size_t>(cells_.cells[2]), 0);
  cells_.members = members_.data();
  cells_.counts = counts_.data();
}

void ParticleStore::index_all() {
  cell_of_.assign(size_, -1);
  listed_at_ = sites_;
  cells_.sites = sites_.data();
  for (Found* found : {&found_, &renewal_}) {
    found->inner.resize(size_ + 8);
    found->outer.resize(size_ + 8);
    found->candidates.resize(size_ + 8 + cells_.capacity);
  }
  renewed_.resize(size_ + 1);
  make_cells();
  for (std::size_t i = 0; i < size_; ++i) put_into_cell(static_cast<std::int32_t>(i));
  if (lists_ == Lists::none) return;
  near_counts_.assign(size_, 0);
  near_.resize(size_ * near_capacity_);
  for (std::size_t i = 0; i < size_; ++i)
    std::fill_n(near_.begin() + static_cast<std::ptrdiff_t>(i * near_capacity_), near_capacity_,
                static_cast<std::int32_t>(i));
  for (std::size_t i = 0; i < size_; ++i) {
    find_within(cells_, sites_[i].at, diameter_ + skin_, diameter_ + skin_, renewal_);
    for (std::size_t k = 0; k < renewal_.inner_count; ++k)
      if (static_cast<std::size_t>(renewal_.inner[k]) < i) {
        add_neighbour(static_cast<std::int32_t>(i), renewal_.inner[k]);
        add_neighbour(renewal_.inner[k], static_cast<std::int32_t>(i));
      }
  }
}

void ParticleStore::put_into_cell(std::int32_t i) {
  const std::size_t cell = cell_at(sites_[static_cast<std::size_t>(i)]);
  if (static_cast<std::size_t>(counts_[cell]) == cells_.capacity) grow_cells();
  members_[cell * cells_.capacity + static_cast<std::size_t>(counts_[cell]++)] = i;
  cell_of_[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(cell);
  const std::size_t layer = cell % layer_counts_.size();
  ++layer_counts_[layer];
  layers_in_use_ = std::max(layers_in_use_, layer + 1);
}

void ParticleStore::take_from_cell(std::int32_t i) {
  const auto cell = static_cast<std::size_t>(cell_of_[static_cast<std::size_t>(i)]);
  const auto first = members_.begin() + static_cast<std::ptrdiff_t>(cell * cells_.capacity);
  const auto last = first + --counts_[cell];
  *std::find(first, last, i) = *last;
  --layer_counts_[cell % layer_counts_.size()];
}

void ParticleStore::grow_cells() {
  // No more than needed: searches copy cells in full.
  const std::size_t old_capacity = cells_.capacity, capacity = old_capacity + 8;
  std::vector<std::int32_t> members(counts_.size() * capacity, 0);
  for (std::size_t cell = 0; cell < counts_.size(); ++cell)
    std::copy_n(members_.begin() + static_cast<std::ptrdiff_t>(cell * old_capacity), counts_[cell],
                members.begin() + static_cast<std::ptrdiff_t>(cell * capacity));
  members_ = std::move(members);
  cells_.members = members_.data();
  cells_.capacity = capacity;
  for (Found* found : {&found_, &renewal_}) found->candidates.resize(size_ + 8 + capacity);
}

// Those that move_sites wrote down.
void ParticleStore::renew(std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t i = renewed_[k];
    take_from_cell(i);
    put_into_cell(i);
    listed_at_[static_cast<std::size_t>(i)] = sites_[static_cast<std::size_t>(i)];
  }
  if (lists_ == Lists::kept)
    for (std::size_t k = 0; k < count; ++k) renew_lists(renewed_[k]);
}

void ParticleStore::renew_lists(std::int32_t i) {
  forget_neighbours(i);
  find_within(cells_, sites_[static_cast<std::size_t>(i)].at, diameter_ + skin_, diameter_ + skin_, renewal_);
  for (std::size_t k = 0; k < renewal_.inner_count; ++k) {
    const std::int32_t j = renewal_.inner[k];
    if (j == i) continue;
    add_neighbour(i, j);
    add_neighbour(j, i);
  }
}

void ParticleStore::forget_neighbours(std::int32_t i) {
  const auto row = [&](std::int32_t k) { return near_.data() + static_cast<std::size_t>(k) * near_capacity_; };
  for (std::int32_t k = 0; k < near_counts_[static_cast<std::size_t>(i)]; ++k) {
    const std::int32_t j = row(i)[k];
    std::int32_t* last = row(j) + --near_counts_[static_cast<std::size_t>(j)];
    *std::find(row(j), last, i) = *last;
    *last = j;
    row(i)[k] = i;
  }
  near_counts_[static_cast<std::size_t>(i)] = 0;
}

void ParticleStore::add_neighbour(std::int32_t i, std::int32_t j) {
  std::int32_t& count = near_counts_[static_cast<std::size_t>(i)];
  if (static_cast<std::size_t>(count) == near_capacity_) grow_lists();
  near_[static_cast<std::size_t>(i) * near_capacity_ + static_cast<std::size_t>(count++)] = j;
}

void ParticleStore::grow_lists() {
  const std::size_t capacity = near_capacity_ + 8;
  std::vector<std::int32_t> near(near_counts_.size() * capacity);
  for (std::size_t i = 0; i < near_counts_.size(); ++i) {
    const auto from = near_.begin() + static_cast<std::ptrdiff_t>(i * near_capacity_);
    const auto to = near.begin() + static_cast<std::ptrdiff_t>(i * capacity);
    std::fill_n(std::copy_n(from, near_capacity_, to), 8, static_cast<std::int32_t>(i));
  }
  near_ = std::move(near);
  near_capacity_ = capacity;
}

}  // namespace grainvdb::spot
