#include "spot/particle_store.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace grainvdb::spot {
namespace {

// Beyond walls there is room for the grains that are pushed there, and for those that fall through the floor.
constexpr double margin_in_diameters = 2;
constexpr double cell_in_diameters = 2;
// Of places in a cell at first: what a dense packing needs.
constexpr std::size_t first_capacity = 16;
// Kernels write registers in full.
constexpr std::size_t spare = 16;
// Of lists that are made on request: more than what single precision loses.
constexpr double least_skin_in_diameters = 1e-3;
// Distances are compared in single precision: a particle counts that is farther away by some 1e-6 of the radius.
constexpr double slack_in_diameters = 1e-5;
// As a distance, a mark must be nothing where a particle is, and beyond every radius where a place is empty.
constexpr double mark_in_diameters = 1e-5;
// Differences wrap at 2³² counts: a period is as long as that. Along other axes none exceeds 2³¹.
constexpr double period_counts = 0x1p32, open_counts = 0x1p31;
constexpr std::int32_t no_lower = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t no_upper = std::numeric_limits<std::int32_t>::max();

std::uint32_t as_unsigned(std::int32_t counts) {
  return static_cast<std::uint32_t>(counts);
}
std::int32_t as_signed(std::uint32_t counts) {
  return static_cast<std::int32_t>(counts);
}
std::size_t index(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

ParticleStore::ParticleStore(const Box& box, const Packing& packing, Neighbours neighbours, const Floor& floor,
                             double skin_in_diameters)
    : box_(box),
      diameter_(packing.diameter),
      neighbours_(neighbours),
      skin_(packing.diameter * (neighbours == Neighbours::listed ? skin_in_diameters : least_skin_in_diameters)) {
  set_scales(floor);
  make_cells();
  std::vector<Mover> particles;
  for (std::size_t i = 0; i < packing.id.size(); ++i) {
    Site site = site_at(packing.position[i]);
    for (std::size_t a = 0; a < 3; ++a) site.at[a] = std::clamp(site.at[a], limits_.lowest[a], limits_.highest[a]);
    particles.push_back({site, packing.id[i]});
  }
  fill(std::move(particles));
}

void ParticleStore::set_scales(const Floor& floor) {
  // A third of the skin, most of it along z, where particles drift.
  const double third = neighbours_ == Neighbours::listed ? skin_ / 3 : 0;
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
    limits_.trigger[a] = static_cast<std::int32_t>(third > 0 ? share[a] * third / unit_[a]
                                                             : std::min(0.5 * cells_.per_cell[a] + 1, open_counts - 1));
    limits_.lowest[a] = limits_.exit[a] = no_lower;
    limits_.highest[a] = no_upper;
    if (periodic) continue;
    const double below = a == 2 ? floor.sinking : 0;
    limits_.lowest[a] = static_cast<std::int32_t>((margin - below) / unit_[a]);
    limits_.highest[a] = static_cast<std::int32_t>((length - margin) / unit_[a]);
  }
  cells_.unit[3] = static_cast<float>(mark_in_diameters * diameter_);
  cells_.slack = third + slack_in_diameters * diameter_;
  limits_.lowest[3] = limits_.exit[3] = no_lower;
  limits_.highest[3] = limits_.trigger[3] = no_upper;
  limits_without_exit_ = limits_;
  if (!box_.periodic[2] && std::isfinite(floor.exit))
    limits_.exit[2] = static_cast<std::int32_t>(std::ceil((margin_in_diameters * diameter_ - floor.exit) / unit_[2]));
}

void ParticleStore::make_cells() {
  const auto middle = [&](std::size_t a, int cell) {
    return as_signed(static_cast<std::uint32_t>((cell + 0.5) * cells_.per_cell[a]));
  };
  for (int i = 0; i < cells_.cells[0]; ++i)
    for (int j = 0; j < cells_.cells[1]; ++j)
      for (int k = 0; k < cells_.cells[2]; ++k) middles_.push_back({{middle(0, i), middle(1, j), middle(2, k)}});
  rows_.assign(middles_.size(), 0);
  layer_counts_.assign(index(cells_.cells[2]), 0);
  cells_.middles = middles_.data();
  cells_.rows = rows_.data();
  cells_.capacity = first_capacity;
}

Vec3 ParticleStore::position_of(const Site& site) const {
  Vec3 x{};
  for (std::size_t a = 0; a < 3; ++a) x[a] = origin_[a] + as_unsigned(site.at[a]) * unit_[a];
  return x;
}

ParticleStore::Bounds ParticleStore::bounds(double distance) const {
  Bounds result{{no_lower, no_lower, no_lower}, {no_upper, no_upper, no_upper}};
  for (std::size_t a = 0; a < 3; ++a) {
    if (box_.periodic[a]) continue;
    const double reach = (margin_in_diameters * diameter_ + distance) / unit_[a];
    result.lowest[a] = static_cast<std::int32_t>(std::ceil(reach));
    result.highest[a] = static_cast<std::int32_t>(open_counts - 1 - std::ceil(reach));
  }
  return result;
}

Site ParticleStore::site_at(const Vec3& x) const {
  Site site;
  for (std::size_t a = 0; a < 3; ++a) {
    const double counts = (box_.wrap(static_cast<int>(a), x[a]) - origin_[a]) / unit_[a];
    const double last = (box_.periodic[a] ? period_counts : open_counts) - 1;
    site.at[a] = as_signed(static_cast<std::uint32_t>(std::clamp(counts, 0.0, last)));
  }
  return site;
}

std::vector<std::int32_t> ParticleStore::places() const {
  std::vector<std::int32_t> result;
  result.reserve(size_);
  for (std::size_t i = 0; i < sites_.size(); ++i)
    if (sites_[i].mark != Site::empty) result.push_back(static_cast<std::int32_t>(i));
  return result;
}

// A particle is at most a share of the skin outside of its cell, and so in the next layer at the farthest.
bool ParticleStore::reaches(double height) {
  while (layers_in_use_ > 0 && layer_counts_[layers_in_use_ - 1] == 0) --layers_in_use_;
  if (layers_in_use_ == 0) return height < box_.lo[2];
  const auto is_below = [&](std::size_t layers) {
    return height < origin_[2] + static_cast<double>(layers) * cells_.edge[2];
  };
  if (is_below(layers_in_use_ - 1)) return true;
  if (!is_below(layers_in_use_ + 1)) return false;
  const std::size_t lowest = is_below(layers_in_use_) ? layers_in_use_ - 1 : layers_in_use_;
  if (holds_above(high_, lowest)) return true;
  const auto found = find_above(lowest);
  if (found) high_ = *found;
  return found.has_value();
}

// A particle in that layer or higher, of those in the two highest layers of cells.
std::optional<std::int32_t> ParticleStore::find_above(std::size_t layer) const {
  const std::size_t layers = layer_counts_.size(), first = std::max<std::size_t>(layers_in_use_, 2) - 2;
  for (std::size_t column = 0; column < rows_.size(); column += layers)
    for (std::size_t i = (column + first) * cells_.capacity; i < (column + layers_in_use_) * cells_.capacity; ++i)
      if (holds_above(static_cast<std::int32_t>(i), layer)) return static_cast<std::int32_t>(i);
  return std::nullopt;
}

std::span<const std::int32_t> ParticleStore::find(const Site& centre, double radius) {
  ball_.centre = centre;
  ball_.radius = radius;
  return std::span(found_).first(find_within(cells_, ball_, found_.data()));
}

// Whether particles that far from the centre may come to a wall or an exit.
Passage ParticleStore::passage(const Site& centre, double radius, const Site& displacement) const {
  bool limited = false;
  for (std::size_t a = 0; a < 3; ++a) {
    if (box_.periodic[a]) continue;
    const double range =
        radius / unit_[a] * (1 + slack_in_diameters) + std::abs(static_cast<double>(displacement.at[a]));
    const double at = as_unsigned(centre.at[a]);
    limited |= at - range <= std::max(limits_.lowest[a], limits_.exit[a]) || at + range >= limits_.highest[a];
  }
  return {radius, displacement, limited};
}

Lists ParticleStore::output() {
  return {away_.data(), 0, marked_.data(), 0};
}

std::size_t ParticleStore::move_within(const Site& centre, double radius, const Site& displacement) {
  Lists lists = output();
  ball_.centre = centre;
  ball_.radius = radius;
  const Passage spot = passage(centre, radius, displacement);
  const std::size_t moved = grainvdb::spot::move_within(cells_, ball_, spot, limits_, lists);
  settle(std::span(away_).first(lists.away_count), limits_);
  return moved;
}

std::size_t ParticleStore::move_and_mark(const Site& centre, const Radii& radii, const Site& displacement) {
  Lists lists = output();
  ball_.centre = centre;
  ball_.radius = std::max(radii.moved, radii.marked);
  const Passage spot = passage(centre, radii.moved, displacement);
  const std::size_t moved = grainvdb::spot::move_and_mark(cells_, ball_, spot, limits_without_exit_, lists);
  zone_.assign(marked_.begin(), marked_.begin() + static_cast<std::ptrdiff_t>(lists.zone_count));
  settle(std::span(away_).first(lists.away_count), limits_without_exit_);
  return moved;
}

void ParticleStore::list_zone() {
  if (neighbours_ != Neighbours::listed_on_request) return;
  for (const std::int32_t i : zone_) near_.set(i, find(site(i), diameter_ + skin_));
}

void ParticleStore::move_zone(std::span<const Site> displacements) {
  move_each(zone_, displacements);
  zone_.clear();
}

void ParticleStore::move_each(std::span<const std::int32_t> places, std::span<const Site> displacements) {
  const std::size_t count =
      grainvdb::spot::move_each(sites_.data(), listed_at_.data(), places, displacements.data(), limits_, away_.data());
  settle(std::span(away_).first(count), limits_);
}

std::vector<std::int64_t> ParticleStore::take_left() {
  std::sort(left_.begin(), left_.end());
  return std::exchange(left_, {});
}

void ParticleStore::compact() {
  std::vector<Mover> particles;
  particles.reserve(size_);
  for (const std::int32_t i : places()) particles.push_back({site(i), id(i)});
  fill(std::move(particles));
}

std::size_t ParticleStore::cell_at(const Site& site) const {
  std::size_t cell = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto n = static_cast<std::uint64_t>(cells_.cells[a]);
    cell = cell * n + (as_unsigned(site.at[a]) * n >> (cells_.periodic[a] ? 32U : 31U));
  }
  return cell;
}

void ParticleStore::fill(std::vector<Mover> particles) {
  const auto key = [&](const Mover& p) { return std::tuple(cell_at(p.site), p.id); };
  std::sort(particles.begin(), particles.end(), [&](const Mover& p, const Mover& q) { return key(p) < key(q); });
  std::fill(rows_.begin(), rows_.end(), 0);
  std::fill(layer_counts_.begin(), layer_counts_.end(), 0);
  size_ = layers_in_use_ = 0;
  sites_.clear();
  resize_places();
  near_.reset(neighbours_ == Neighbours::none ? 0 : sites_.size());
  for (const Mover& p : particles) put(p.site, p.id);
  if (neighbours_ != Neighbours::listed) return;
  listed_at_ = sites_;
  cells_.listed_at = listed_at_.data();
  for (const std::int32_t i : places())
    for (const std::int32_t j : find(site(i), diameter_ + skin_))
      if (j < i) near_.join(i, j);
}

// Room for all places of all cells; those that are new are empty.
void ParticleStore::resize_places() {
  const std::size_t before = sites_.size(), after = rows_.size() * cells_.capacity;
  sites_.resize(after);
  id_.resize(after);
  for (std::size_t i = before; i < after; ++i) {
    sites_[i] = middles_[i / cells_.capacity];
    sites_[i].mark = Site::empty;
  }
  if (neighbours_ != Neighbours::none) {
    // The middles of cells; where no lists are kept it stays so.
    listed_at_.resize(after);
    std::copy(sites_.begin() + static_cast<std::ptrdiff_t>(before), sites_.end(),
              listed_at_.begin() + static_cast<std::ptrdiff_t>(before));
  }
  if (neighbours_ == Neighbours::listed) cells_.listed_at = listed_at_.data();
  cells_.sites = sites_.data();
  for (std::vector<std::int32_t>* list : {&found_, &away_, &marked_}) list->resize(after + spare);
}

std::int32_t ParticleStore::put(const Site& site, std::int64_t id) {
  const std::size_t cell = cell_at(site);
  const std::int32_t place = free_place(cell);
  sites_[index(place)] = site;
  id_[index(place)] = id;
  const std::size_t in_cell = index(place) % cells_.capacity;
  rows_[cell] = std::max(rows_[cell], static_cast<std::int32_t>(in_cell / row_size + 1));
  const std::size_t layer = cell % layer_counts_.size();
  ++layer_counts_[layer];
  layers_in_use_ = std::max(layers_in_use_, layer + 1);
  ++size_;
  return place;
}

std::int32_t ParticleStore::free_place(std::size_t cell) {
  const auto is_free = [](const Site& site) { return site.mark == Site::empty; };
  const auto first = sites_.begin() + static_cast<std::ptrdiff_t>(cell * cells_.capacity);
  const auto last = first + static_cast<std::ptrdiff_t>(cells_.capacity);
  const auto free = std::find_if(first, last, is_free);
  if (free != last) return static_cast<std::int32_t>(free - sites_.begin());
  widen_cells();
  return free_place(cell);
}

void ParticleStore::take_out(std::int32_t i) {
  const std::size_t cell = index(i) / cells_.capacity, layer = cell % layer_counts_.size();
  if (neighbours_ == Neighbours::listed) near_.forget(i);
  Site& site = sites_[index(i)];
  // Not away from the middle of the cell, nor from where it was listed.
  site = middles_[cell];
  site.mark = Site::empty;
  if (neighbours_ == Neighbours::listed) listed_at_[index(i)] = site;
  --layer_counts_[layer];
  --size_;
  const auto is_free = [](const Site& s) { return s.mark == Site::empty; };
  const auto row_is_free = [&](std::int32_t row) {
    const auto first = sites_.begin() + static_cast<std::ptrdiff_t>(cell * cells_.capacity + index(row) * row_size);
    return std::all_of(first, first + row_size, is_free);
  };
  while (rows_[cell] > 0 && row_is_free(rows_[cell] - 1)) --rows_[cell];
}

// Every cell gets another row. What is kept by place follows.
void ParticleStore::widen_cells() {
  const std::size_t before = cells_.capacity, after = before + row_size;
  const std::vector<Site> sites = std::exchange(sites_, {}), listed_at = listed_at_;
  const std::vector<std::int64_t> ids = id_;
  cells_.capacity = after;
  resize_places();
  const auto widened = [&](std::size_t i) { return i / before * after + i % before; };
  for (std::size_t i = 0; i < sites.size(); ++i) {
    sites_[widened(i)] = sites[i];
    id_[widened(i)] = ids[i];
  }
  for (std::size_t i = 0; i < listed_at.size(); ++i) listed_at_[widened(i)] = listed_at[i];
  if (neighbours_ == Neighbours::listed) near_.widen_cells(before, after);
  if (neighbours_ == Neighbours::listed_on_request) near_.reset(sites_.size());
  for (std::vector<std::int32_t>* list : {&zone_, &renewed_})
    for (std::int32_t& i : *list) i = static_cast<std::int32_t>(widened(index(i)));
  for (Mover& m : movers_) m.from = static_cast<std::int32_t>(widened(index(m.from)));
}

// Those that a kernel wrote down leave, change their cells, and get new lists.
void ParticleStore::settle(std::span<const std::int32_t> away, const MoveLimits& limits) {
  if (away.empty()) return;
  movers_.clear();
  renewed_.clear();
  for (const std::int32_t i : away) {
    if (site(i).at[2] < limits.exit[2]) {
      left_.push_back(id(i));
      take_out(i);
    } else if (cell_at(site(i)) == index(i) / cells_.capacity) {
      renewed_.push_back(i);
    } else {
      movers_.push_back({site(i), id(i), i});
      take_out(i);
    }
  }
  change_cells();
  if (neighbours_ != Neighbours::listed) return;
  for (const std::int32_t i : renewed_) listed_at_[index(i)] = site(i);
  for (const std::int32_t i : renewed_) list_neighbours(i);
}

void ParticleStore::change_cells() {
  for (const Mover& m : movers_) {
    const auto in_zone = m.site.mark == Site::in_zone ? std::find(zone_.begin(), zone_.end(), m.from) : zone_.end();
    const std::int32_t to = put(m.site, m.id);
    if (in_zone != zone_.end()) *in_zone = to;
    renewed_.push_back(to);
  }
}

void ParticleStore::list_neighbours(std::int32_t i) {
  near_.forget(i);
  for (const std::int32_t j : find(site(i), diameter_ + skin_))
    if (j != i) near_.join(i, j);
}

}  // namespace grainvdb::spot
