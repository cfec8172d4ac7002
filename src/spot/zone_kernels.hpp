#pragma once
/// The two inner loops of the spot model, on vector registers: finding the particles within reach of a point, and the
/// push that a particle gets from those that it overlaps.
///
/// Positions are whole numbers of a small unit per axis and differences wrap, so that the minimum image costs nothing
/// and displacements add without rounding. Pushes are rounded to that unit before they are summed: sums do not depend
/// on the order of neighbours nor on the width of registers.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace grainvdb::spot {

/// One particle. The stamp says in which event it last lay in the zone that is relaxed.
struct alignas(16) Site {
  std::array<std::int32_t, 3> at{};
  std::int32_t stamp = 0;
};

/// The cells of the neighbour search, as the kernels see them. Cells along z follow each other.
struct CellView {
  const Site* sites = nullptr;
  const std::int32_t* members = nullptr;  ///< of cell c: members[c * capacity] …; a multiple of 8 each
  const std::int32_t* counts = nullptr;
  std::size_t capacity = 0;
  std::array<int, 3> cells{};
  std::array<bool, 3> periodic{};
  std::array<float, 3> unit{};       ///< length of one count along each axis
  std::array<double, 3> per_cell{};  ///< counts per cell
  std::array<double, 3> edge{};      ///< of a cell [length]
  double slack = 0;                  ///< how far a particle may lie outside its cell [length]
};

/// Indices of the particles within the inner radius, and of those between the two radii.
struct Found {
  std::vector<std::int32_t> inner, outer;  ///< longer than what they hold
  std::vector<std::int32_t> candidates;    ///< scratch
  std::size_t inner_count = 0, outer_count = 0;
};

/// The particles within `outer` [length] of a point, divided at `inner` ≤ outer. `found` has room for all particles and
/// eight more, for candidates a cell more. Along periodic axes 2 · outer must not exceed the period.
void find_within(const CellView& cells, const std::array<std::int32_t, 3>& centre, double inner, double outer,
                 Found& found);

/// Asks the memory for the members of the cells that a search there will visit, without waiting for them.
void fetch_within(const CellView& cells, const std::array<std::int32_t, 3>& centre, double radius);

/// What pushes depend on.
struct PushLaw {
  std::array<float, 3> unit{};  ///< as above
  float diameter = 0;           ///< [length]
  float strength = 0;           ///< α
  std::int32_t stamp = 0;       ///< of the particles inside the zone
};

/// Lists of neighbours: those of particle i are members[i * capacity] …, counts[i] of them, then i itself up to the
/// next multiple of 8.
struct NearView {
  const std::int32_t* members = nullptr;
  const std::int32_t* counts = nullptr;
  std::size_t capacity = 0;
};

/// Writes for each listed particle i to `pushes` [counts]: Σ_j f α (d/r - 1) (x_i - x_j) over its neighbours with
/// r = |x_i - x_j| < d, where f = 1/2 for those inside the zone and 1 for the others.
void push_apart(const Site* sites, const NearView& near, const std::int32_t* indices, std::size_t count,
                const PushLaw& law, Site* pushes);

/// How positions are kept between walls, and when they have changed by so much that cells and lists are renewed; per
/// axis [counts], the fourth entry is not used.
struct MoveLimits {
  alignas(16) std::array<std::int32_t, 4> lowest{};
  alignas(16) std::array<std::int32_t, 4> highest{};
  alignas(16) std::array<std::int32_t, 4> trigger{};
};

/// Adds displacements [counts] to the sites of the listed particles: `displacements[stride * k]` to the k-th, so that a
/// stride of 0 moves all alike. Writes those that are `trigger` or more away from their place in `listed_at` to
/// `renewed`, which has room for all, and returns how many there are.
std::size_t move_sites(Site* sites, const Site* listed_at, const std::int32_t* indices, std::size_t count,
                       const Site* displacements, std::size_t stride, const MoveLimits& limits, std::int32_t* renewed);

}  // namespace grainvdb::spot
