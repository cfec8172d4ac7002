#pragma once
/// The spot model with relaxation, event by event (Bazant 2006; Rycroft, Bazant, Grest and Landry 2006; Rycroft, Wong
/// and Bazant 2010). A spot carries a little free volume upwards in a random walk: when it steps by v, every particle
/// within its radius moves by -v/w, and particles near it that overlap are then pushed apart once. There are no forces.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "spot/container.hpp"
#include "spot/particle_store.hpp"
#include "spot/random.hpp"

namespace grainvdb::spot {

/// Pushing particles apart after a spot's step.
struct Relaxation {
  std::int64_t every = 1;  ///< every so many steps of any spot; 0: never
  double probability = 1;  ///< of those steps
  double radius = 0;       ///< r_e: particles within it are moved, others stay [length]
  double strength = 0.8;   ///< α
};

/// Steps biased towards regions with more particles, which lets a free surface avalanche: a candidate step is taken
/// with a probability ∝ p^exponent, p the number of particles within the spot's radius after it.
struct Bias {
  double exponent = 3;
  double volume = 0;   ///< V_s/V_p; the particles of a spot share it, so that w = p V_p/V_s
  double fewest = 20;  ///< p is taken as at least that
};

struct SpotParameters {
  enum class Entry { centre, spread };
  enum class Direction { up, any };
  double radius = 0;          ///< r_s [length]
  double influence = 0;       ///< w; not used with a bias
  Vec3 step{};                ///< Δx, Δy, Δz, each ≥ 0: signs are drawn, along z only for Direction::any [length]
  double hop_rate = 0;        ///< μ_s, steps of a spot per time [1/time]
  double insertion_rate = 0;  ///< λ, through the orifice [1/time]
  std::size_t count = 0;      ///< spots that are there from the start, at random places
  Entry entry = Entry::centre;
  double entry_depth = 0;  ///< how far below the floor they enter, at most 2 diameters [length]
  Direction direction = Direction::up;
  double wall_distance = 0;  ///< d_w: spots stay that far from side walls; may be negative [length]
  /// How far spots stay from the floor beside the orifice; 0: they pass over it and push grains onto it [length]
  double floor_distance = 0;
  Relaxation relaxation;
  std::optional<Bias> bias;
};

/// A particle that has fallen through the orifice.
struct Drained {
  std::int64_t id = 0;
  double time = 0;
};

struct SpotCounters {
  std::uint64_t steps = 0;      ///< of spots
  std::uint64_t relaxed = 0;    ///< of these, followed by a relaxation
  std::uint64_t inserted = 0;   ///< spots
  std::uint64_t removed = 0;    ///< spots that left the packing
  std::uint64_t displaced = 0;  ///< particles moved by spots, each as often as it was moved
};

/// Choices where the publications leave room: spots enter in the plane of the floor, or below; a spot is removed when
/// its turn comes and it is above the highest layer of the packing; a particle has left when its centre is half a
/// diameter below the floor; pushes by walls have strength 1. The run depends on the seed alone, not on threads, the
/// instruction set or the order of the packing's rows.
class SpotModel {
 public:
  SpotModel(const Container& container, const Packing& packing, const SpotParameters& parameters, std::uint64_t seed);

  /// Runs until that time.
  void advance(double end);
  /// Runs that many events, for measurements; fewer when nothing can happen any more.
  void run_events(std::uint64_t count);

  double time() const { return time_; }
  const ParticleStore& particles() const { return particles_; }
  const std::vector<Vec3>& spots() const { return spots_; }
  const std::vector<Drained>& drained() const { return drained_; }
  const SpotCounters& counters() const { return counters_; }
  /// Puts particles in order in memory; changes indices, not the run.
  void compact() { particles_.compact(); }

 private:
  /// What comes next; nothing has happened yet.
  struct Event {
    double time = 0;
    std::optional<std::size_t> spot;  ///< that steps; none: one enters
    Vec3 step{};                      ///< before walls cut it; not known yet with a bias
  };
  Event draw_event();
  void next_event();
  void insert_spot();
  void step_spot(std::size_t k, const Vec3& drawn);
  bool is_above_packing(const Vec3& spot);
  void remove_spot(std::size_t k);
  static Vec3 middle_of(const Vec3& spot, const Vec3& step);
  double influence_at(const Site& centre);
  Vec3 draw_step();
  Vec3 kept_inside(const Vec3& spot, Vec3 step) const;
  std::optional<Vec3> biased_step(const Vec3& spot);
  void displace(const Vec3& centre, const Vec3& step);
  Site rounded(const Vec3& displacement);
  bool is_relaxed();
  void relax(const Vec3& centre);
  void push_off_walls(const Vec3& centre);

  Container container_;
  SpotParameters parameters_;
  ParticleStore particles_;
  Random random_;
  double time_ = 0;
  Event next_;
  std::vector<Vec3> spots_;
  std::vector<Drained> drained_;
  SpotCounters counters_;
  PushLaw law_;
  Vec3 rest_{};  ///< what rounding has left over from displacements [counts]
  std::vector<Site> pushes_;
};

}  // namespace grainvdb::spot
