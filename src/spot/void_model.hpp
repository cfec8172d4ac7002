#pragma once
/// The void model (Litwiniszyn 1958; Mullins 1972; Caram and Hong 1991), event by event: voids rise through a lattice
/// of grains in a random walk, and each grain that a void changes places with falls into its place. It exists to show
/// what fails: grains spread as fast as the voids, b_p/b = 1, where real ones spread a few hundred times less.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/container.hpp"
#include "spot/random.hpp"
#include "spot/spot_model.hpp"
#include "spot/staggered_lattice.hpp"

namespace grainvdb::spot {

struct VoidParameters {
  using Entry = SpotParameters::Entry;
  double hop_rate = 0;        ///< hops of a void per time [1/time]
  double insertion_rate = 0;  ///< > 0: of voids, through the orifice [1/time]
  /// centre: at the sites of the lowest layer that are nearest to the middle of the orifice; spread: at all over it.
  Entry entry = Entry::centre;
};

struct VoidCounters {
  std::uint64_t hops = 0;
  std::uint64_t waits = 0;     ///< turns of voids that had voids above only
  std::uint64_t inserted = 0;  ///< voids, as many as grains have left
  std::uint64_t removed = 0;   ///< voids that have reached the surface
};

/// A void enters where a grain falls out of the lowest layer. It hops to one of the upper neighbours that hold grains,
/// each with the same probability; a void below other voids waits. With nothing but air above, it is air itself.
/// b = Δx²/(2Δz) in the convention of ∂v/∂z = b ∂²v/∂x². The run depends on the seed alone.
class LatticeVoids {
 public:
  /// Throws ConfigError where no site of the lowest layer lies over the orifice. The lattice is full of grains.
  LatticeVoids(const Container& container, const StaggeredLattice& lattice, const VoidParameters& parameters,
               std::uint64_t seed);

  /// Runs until that time.
  void advance(double end);
  /// Runs that many events; what tries to enter where no grain is left counts, too.
  void run_events(std::uint64_t count);

  double time() const { return time_; }
  const StaggeredLattice& lattice() const { return lattice_; }
  /// By site: the id of the grain there, `empty` for a void, or `air`.
  const std::vector<std::int64_t>& sites() const { return sites_; }
  static constexpr std::int64_t empty = 0, air = -1;
  /// The sites of the voids.
  const std::vector<std::size_t>& voids() const { return voids_; }
  std::size_t grains() const { return grains_; }
  const std::vector<Drained>& drained() const { return drained_; }
  const VoidCounters& counters() const { return counters_; }

 private:
  void choose_entries(const Container& container, VoidParameters::Entry entry);
  void next_event();
  void draw_time();
  void insert_void();
  void hop(std::size_t k);

  StaggeredLattice lattice_;
  VoidParameters parameters_;
  Random random_;
  double time_ = 0;
  double next_ = 0;  ///< time of the next event
  std::vector<std::int64_t> sites_;
  std::vector<std::size_t> voids_, entries_;
  std::size_t grains_ = 0;
  std::vector<Drained> drained_;
  VoidCounters counters_;
};

}  // namespace grainvdb::spot
