#pragma once
/// Every call of the library that is measured.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bin/buckets.hpp"
#include "grainvdb/kernel.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/topology.hpp"
#include "grids.hpp"
#include "scene.hpp"
#include "splat/bricks.hpp"
#include "splat/candidates.hpp"
#include "splat/records.hpp"

namespace grainvdb::bench {

/// Lattice and kernel of a scene at voxel size h.
struct Setting {
  explicit Setting(double h) : lattice(h, {0, 0, 0}), kernel(cutoff) {}
  Lattice lattice;
  LucyKernel kernel;
};

/// Particles to grids: sorted into leaves, active voxels found, splatted, stored in FloatGrids.
Grids splat_to_grids(const Setting& setting, const Scene& scene, std::span<const double> q, int channels);

/// What the kernel loop needs, made before the clock starts.
struct Prepared {
  Buckets buckets;
  std::shared_ptr<const Topology> topology;
};
Prepared prepare(const Setting& setting, const Scene& scene);

/// The kernel loop: candidates, weights and sums of every leaf, each dropped when it is done.
void splat_prepared(const Setting& setting, const Prepared& prepared, std::span<const double> q, int channels);

/// The loop over candidates alone: picking, weights and sums of some leaves spread over the scene, whose candidates and
/// values were collected before and lie in the cache, as they do when the splat comes to them.
class PreparedLeaves {
 public:
  PreparedLeaves(const Setting& setting, const Prepared& prepared, std::span<const double> q, int channels);
  /// Every leaf `passes` times.
  void splat();
  std::size_t pairs() const { return passes * pairs_; }

 private:
  static constexpr std::size_t most = 40;
  static constexpr int passes = 20;

  struct Leaf {
    LeafCandidates candidates;
    LeafRecords records;
    LeafMask active;
  };
  std::vector<Leaf> leaves_;
  std::size_t pairs_ = 0;  // kernel values inside the support, of one pass
  std::size_t stride_ = 0;
  int channels_;
  float voxel_;
  LeafSums sums_;
};

/// A way to evaluate the line integrals of the contacts.
struct ContactMethod {
  std::string name;
  LineIntegral integral;
  double error = 0;  ///< of one branch at most, in units of W(0)
};
std::vector<ContactMethod> contact_methods();

/// Half branches to grids. `q` is laid out [branch][channel].
Grids contacts_to_grids(const Setting& setting, const HalfBranches& branches, std::span<const double> q, int channels,
                        const ContactMethod& method);

/// Runs a pipeline file into a folder, as the command does.
void run_pipeline_file(const std::string& file, const std::string& folder);

/// The instruction set of the splat.
std::string instruction_set();

}  // namespace grainvdb::bench
