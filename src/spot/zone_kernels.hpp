#pragma once
/// The loops of the spot model over the cells near a point, on vector registers: moving, marking or finding the
/// particles within reach.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spot/site.hpp"

namespace grainvdb::spot {

/// Places per row: cells are filled, and swept, by rows.
constexpr std::size_t row_size = 4;

/// Particles by the cell that they are in: cell c has the places c * capacity … (c + 1) * capacity - 1, those in use in
/// its first rows. Cells along z follow each other.
struct CellView {
  Site* sites = nullptr;
  const Site* listed_at = nullptr;     ///< where each particle was when its list was made; nothing without lists
  const std::int32_t* rows = nullptr;  ///< that hold particles, of each cell
  const Site* middles = nullptr;       ///< of the cells
  std::size_t capacity = 0;            ///< a multiple of row_size
  std::array<int, 3> cells{};
  std::array<bool, 3> periodic{};
  alignas(16) std::array<float, 4> unit{};  ///< length of one count along each axis; the fourth turns marks to lengths
  std::array<double, 3> per_cell{};         ///< counts per cell
  std::array<double, 3> edge{};             ///< of a cell [length]
  double slack = 0;                         ///< how far a particle may lie outside its cell [length]
};

/// Cells that follow each other along z.
struct CellRun {
  std::size_t first = 0, count = 0;
};

/// A ball and the cells that it may touch, which the sweeps below fill in. Along periodic axes 2 · radius must not
/// exceed the period.
struct Ball {
  Site centre;
  double radius = 0;          ///< [length]
  std::vector<CellRun> runs;  ///< scratch
};

/// Writes the places of the particles within the ball to `found`, which has room for all places and 16 more; returns
/// how many there are.
std::size_t find_within(const CellView& cells, Ball& ball, std::int32_t* found);

/// How positions are kept between walls, and when they have changed by so much that cells and lists are renewed; per
/// axis [counts], the fourth entry leaves marks alone.
struct MoveLimits {
  alignas(16) std::array<std::int32_t, 4> lowest{};
  alignas(16) std::array<std::int32_t, 4> highest{};
  alignas(16) std::array<std::int32_t, 4> exit{};     ///< below it particles leave
  alignas(16) std::array<std::int32_t, 4> trigger{};  ///< distance from `listed_at`, or from the middle of the cell
};

/// Where kernels write what they find; each has room for all places and 16 more.
struct Lists {
  std::int32_t* away = nullptr;  ///< places of particles that are beyond `trigger` or `exit`
  std::size_t away_count = 0;
  std::int32_t* zone = nullptr;  ///< places of particles that are marked
  std::size_t zone_count = 0;
};

/// What a spot does to the particles near it.
struct Passage {
  double radius = 0;  ///< of the spot, at most that of the ball [length]
  Site displacement;  ///< of the particles within it [counts]; mark 0
  /// Whether some may come to a wall or an exit by it; else limits are not looked at.
  bool limited = true;
};

/// Moves the particles within the radius of the spot; returns how many there are.
std::size_t move_within(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits,
                        Lists& lists);
/// The same, and marks the particles that were within the ball before as in the zone.
std::size_t move_and_mark(const CellView& cells, Ball& ball, const Passage& passage, const MoveLimits& limits,
                          Lists& lists);

/// Adds displacements [counts] to the sites of the listed particles, and takes their marks away. Writes those that are
/// beyond `trigger` or `exit` to `away`, which has room for all, and returns how many there are.
std::size_t move_each(Site* sites, const Site* listed_at, std::span<const std::int32_t> places,
                      const Site* displacements, const MoveLimits& limits, std::int32_t* away);

}  // namespace grainvdb::spot
