#pragma once
/// The particles of a spot run: positions, the cells that find them near a point, and who is near whom.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "grainvdb/box.hpp"
#include "spot/near_lists.hpp"
#include "spot/zone_kernels.hpp"

namespace grainvdb::spot {

/// Equal spheres with ids.
struct Packing {
  double diameter = 0;           ///< [length]
  std::vector<std::int64_t> id;  ///< each once
  std::vector<Vec3> position;    ///< [length]
};

/// The lower end of a box that is not periodic along z.
struct Floor {
  double sinking = 0;  ///< how far centres may get below it, at most 1.8 diameters [length]
  double exit = std::numeric_limits<double>::infinity();  ///< how far below it a particle has left [length]
};

/// Of a spot that moves particles, and of the zone that is relaxed around it [length].
struct Radii {
  double moved = 0, marked = 0;
};

/// Particles lie in memory by cells, so that a sweep over those near a point reads memory in order; each has a place,
/// which it leaves only for another cell. Its cell and its list of neighbours are renewed when it has moved by a share
/// of the lists' skin; where no lists are kept, its cell when it has left it. A sweep and a relaxation cost the same in
/// a packing of any size.
///
/// Lists that are kept are mutual and hold every pair nearer than diameter + skin when the later of its two lists was
/// made. Each then moves by at most skin/3 from where its own list was made, so that the pair comes nearer by at most
/// skin.
class ParticleStore {
 public:
  /// Whether there are lists of neighbours: kept for all particles, or made for those of the zone when they are to be
  /// pushed, which costs less where that is rare.
  enum class Neighbours { none, listed, listed_on_request };
  /// Per axis [counts].
  struct Bounds {
    std::array<std::int32_t, 3> lowest{}, highest{};
    bool hold(const Site& site) const {
      bool inside = true;
      for (std::size_t a = 0; a < 3; ++a) inside &= site.at[a] > lowest[a] && site.at[a] < highest[a];
      return inside;
    }
  };

  /// Centres beyond a wall are put on it. Periodic lengths must be at least four diameters; the caller checks that.
  /// The skin, of lists that are kept, changes what a run costs and not what becomes of the particles.
  /// Memory: about 400 bytes per (2 diameters)³ of the box, 1900 and more with lists.
  ParticleStore(const Box& box, const Packing& packing, Neighbours neighbours, const Floor& floor = {},
                double skin_in_diameters = 0.12);

  /// Places, most of which hold a particle.
  std::size_t slots() const { return sites_.size(); }
  std::size_t size() const { return size_; }
  bool holds(std::int32_t i) const { return site(i).mark != Site::empty; }
  double diameter() const { return diameter_; }
  const Box& box() const { return box_; }
  std::int64_t id(std::int32_t i) const { return id_[static_cast<std::size_t>(i)]; }
  const Site& site(std::int32_t i) const { return sites_[static_cast<std::size_t>(i)]; }
  const Site* sites() const { return sites_.data(); }
  const Vec3& unit() const { return unit_; }
  Vec3 position(std::int32_t i) const { return position_of(site(i)); }
  Vec3 position_of(const Site& site) const;
  /// Between which places nothing is near a wall: farther than that from the ends of axes that are not periodic.
  Bounds bounds(double distance) const;
  Site site_at(const Vec3& x) const;
  /// The places that hold particles.
  std::vector<std::int32_t> places() const;
  /// Whether that height is below the upper end of the highest layer of cells in which there is a particle; of the
  /// box's lower end when there is none. By where particles are, whatever cells they were put in.
  bool reaches(double height);

  /// The places of the particles within a ball. Valid until the next call.
  std::span<const std::int32_t> find(const Site& centre, double radius);
  /// Who may touch whom; empty without lists. Where they are made on request, those of the zone.
  NearView near() const { return near_.view(); }

  /// Moves the particles within a radius by the same whole counts, and returns how many there are. Beyond a wall they
  /// stay on the wall; those beyond the exit leave.
  std::size_t move_within(const Site& centre, double radius, const Site& displacement);
  /// The same, but all that were within the larger radius before are marked: they are the zone. Nothing leaves. Only
  /// with lists.
  std::size_t move_and_mark(const Site& centre, const Radii& radii, const Site& displacement);
  /// The places of the marked particles; valid until the next call that moves some.
  std::span<const std::int32_t> zone() const { return zone_; }
  /// Makes the lists of the marked particles, where none are kept.
  void list_zone();
  /// Moves each particle of the zone by its own counts, and ends the zone. Those beyond the exit leave.
  void move_zone(std::span<const Site> displacements);
  /// The same for any particles. Only with lists.
  void move_each(std::span<const std::int32_t> places, std::span<const Site> displacements);
  /// Takes a particle out.
  void take_out(std::int32_t i);
  /// Whether any have left since the last call of `take_left`.
  bool has_left() const { return !left_.empty(); }
  /// The ids of those that have left since the last call, sorted.
  std::vector<std::int64_t> take_left();
  /// Fills gaps between particles in memory. Places change.
  void compact();

 private:
  struct Mover {
    Site site;
    std::int64_t id = 0;
    std::int32_t from = 0;
  };

  void set_scales(const Floor& floor);
  void make_cells();
  Passage passage(const Site& centre, double radius, const Site& displacement) const;
  std::size_t cell_at(const Site& site) const;
  std::size_t layer_at(const Site& site) const { return cell_at(site) % layer_counts_.size(); }
  bool holds_above(std::int32_t i, std::size_t layer) const { return holds(i) && layer_at(site(i)) >= layer; }
  std::optional<std::int32_t> find_above(std::size_t layer) const;
  Lists output();
  void fill(std::vector<Mover> particles);
  void resize_places();
  std::int32_t put(const Site& site, std::int64_t id);
  std::int32_t free_place(std::size_t cell);
  void widen_cells();
  void settle(std::span<const std::int32_t> away, const MoveLimits& limits);
  void change_cells();
  void list_neighbours(std::int32_t i);

  Box box_;
  double diameter_;
  Neighbours neighbours_;
  double skin_ = 0;
  Vec3 origin_{}, unit_{};
  MoveLimits limits_, limits_without_exit_;
  CellView cells_;
  std::size_t size_ = 0;
  std::vector<std::int64_t> id_;
  std::vector<Site> sites_, listed_at_;
  std::vector<std::int32_t> rows_, layer_counts_;
  std::vector<Site> middles_;
  std::size_t layers_in_use_ = 0;  ///< layers of cells above these hold nothing
  std::int32_t high_ = 0;          ///< the place of a particle that was high up when one was last looked for
  NearLists near_;
  Ball ball_;
  std::vector<std::int32_t> found_, away_, marked_, zone_, renewed_;
  std::vector<Mover> movers_;
  std::vector<std::int64_t> left_;
};

}  // namespace grainvdb::spot
