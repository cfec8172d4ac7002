#pragma once
/// The particles of a spot run: positions, the cells that find them near a point, and who is near whom.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "grainvdb/box.hpp"
#include "spot/zone_kernels.hpp"

namespace grainvdb::spot {

/// Equal spheres with ids.
struct Packing {
  double diameter = 0;           ///< [length]
  std::vector<std::int64_t> id;  ///< each once
  std::vector<Vec3> position;    ///< [length]
};

/// A particle keeps its cell and its list of neighbours until it has moved by a share of the lists' skin; then both are
/// renewed. A search near a point and a relaxation cost the same in a packing of any size.
///
/// Lists are mutual and hold every pair nearer than diameter + skin when the later of its two lists was made. Each then
/// moves by at most skin/3 from where its own list was made, so that the pair comes nearer by at most skin.
class ParticleStore {
 public:
  enum class Lists { none, kept };

  /// Centres beyond a wall are put on it; `below_floor` is how far they may sink below the lower end of a box that is
  /// not periodic along z, at most 1.8 diameters. Periodic lengths must be at least four diameters; the caller checks
  /// that. Memory: 130 bytes per particle, 230 with lists, and about 90 bytes per (2 diameters)³ of the box.
  ParticleStore(const Box& box, const Packing& packing, Lists lists, double below_floor = 0);

  /// Slots, those of particles that were taken out included.
  std::size_t slots() const { return id_.size(); }
  std::size_t size() const { return size_; }
  bool holds(std::int32_t i) const { return cell_of_[static_cast<std::size_t>(i)] >= 0; }
  double diameter() const { return diameter_; }
  const Box& box() const { return box_; }
  std::int64_t id(std::int32_t i) const { return id_[static_cast<std::size_t>(i)]; }
  const Site& site(std::int32_t i) const { return sites_[static_cast<std::size_t>(i)]; }
  const Site* sites() const { return sites_.data(); }
  const Vec3& unit() const { return unit_; }
  Vec3 position(std::int32_t i) const { return position_of(site(i)); }
  Vec3 position_of(const Site& site) const;
  Site site_at(const Vec3& x) const;
  /// Upper end of the highest layer of cells that holds a particle; the lower end of the box when there is none.
  double top();

  /// The particles within two radii of a point, see find_within. Valid until the next call.
  const Found& find(const Site& centre, double inner, double outer);
  /// Prepares the caches for a search around a point that comes soon.
  void fetch(const Site& centre, double radius) const { fetch_within(cells_, centre.at, radius); }
  /// Who may touch whom; empty without lists.
  NearView near() const { return {near_.data(), near_counts_.data(), near_capacity_}; }

  void set_stamp(std::int32_t i, std::int32_t stamp) { sites_[static_cast<std::size_t>(i)].stamp = stamp; }
  /// Moves the listed particles by the same whole counts, or each by its own; beyond a wall they stay on the wall. The
  /// stamps of displacements must be 0.
  void move_alike(std::span<const std::int32_t> indices, const Site& displacement);
  void move_each(std::span<const std::int32_t> indices, std::span<const Site> displacements);
  /// Takes a particle out. Its slot stays until `compact`.
  void take_out(std::int32_t i);
  /// Forgets the slots of those that were taken out, and puts particles that are near each other in space near each
  /// other in memory. All indices change.
  void compact();

 private:
  void set_scales(double below_floor);
  void make_cells();
  std::size_t cell_at(const Site& site) const;
  void index_all();
  void put_into_cell(std::int32_t i);
  void take_from_cell(std::int32_t i);
  void grow_cells();
  void renew(std::size_t count);
  void renew_lists(std::int32_t i);
  void forget_neighbours(std::int32_t i);
  void add_neighbour(std::int32_t i, std::int32_t j);
  void grow_lists();

  Box box_;
  double diameter_;
  Lists lists_;
  double skin_ = 0;
  Vec3 origin_{}, unit_{};
  MoveLimits limits_;
  CellView cells_;
  std::size_t size_ = 0;
  std::vector<std::int64_t> id_;
  std::vector<Site> sites_, listed_at_;
  std::vector<std::int32_t> cell_of_;  ///< -1: taken out
  std::vector<std::int32_t> members_, counts_, layer_counts_;
  std::size_t layers_in_use_ = 0;  ///< layers of cells above these hold nothing
  std::size_t near_capacity_ = 16;
  std::vector<std::int32_t> near_, near_counts_;
  Found found_, renewal_;
  std::vector<std::int32_t> renewed_;
};

}  // namespace grainvdb::spot
