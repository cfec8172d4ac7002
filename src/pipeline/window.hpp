#pragma once
/// The moments of one output time after another, on one lattice: the frames of a window, swept as often as the plan
/// asks.
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "average/moment_sums.hpp"
#include "average/window_sums.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"
#include "grainvdb/region.hpp"
#include "pipeline/frame_context.hpp"
#include "pipeline/material.hpp"
#include "pipeline/schedule.hpp"
#include "pipeline/splat_groups.hpp"

namespace grainvdb {

class WindowAverager {
 public:
  /// Pipeline, plan and schedule must outlive the averager. Moments are summed on the leaves that fields in the region
  /// are made of; everywhere without one.
  WindowAverager(const Pipeline& pipeline, const Plan& plan, const WindowSchedule& schedule, const Lattice& lattice,
                 const std::optional<Region>& region);
  WindowAverager(const WindowAverager&) = delete;
  WindowAverager& operator=(const WindowAverager&) = delete;

  const Lattice& lattice() const { return setting_.lattice; }

  /// What can be computed of a frame before its turn comes. Concurrent calls are safe. Throws LimitError.
  std::unique_ptr<FrameContext> prepare(std::shared_ptr<const Material> material, std::size_t sweep) const;

  /// Adds the next frame of the current sweep. Throws LimitError when the sums would outgrow limits.memory_gb.
  void add(FrameContext& frame, const Visit& visit);
  /// Goes on without the next frame of the current sweep.
  void leave_out(const Visit& visit) { destination(visit); }
  /// Ends a sweep over a window.
  void end_sweep(const Visit& visit);
  /// Of the sweeps that have ended: a view of the sums, which begin_window takes away.
  const MomentMeans& means() const { return *means_; }
  /// Those sums, with those over the blocks of the window; also in the midst of a sweep.
  const WindowSums& sums() const { return *sums_; }
  void begin_window();

  /// Between two frames.
  void save(ByteWriter& to) const;
  /// Into an averager of the same pipeline, plan and schedule that nothing was added to.
  void load(ByteReader& from);

 private:
  WindowSums& destination(const Visit& visit);
  void begin_growing_block(const Visit& visit);
  void join_parts(const Window& window);
  void want_leaves(const SweepGroups& groups, const Region& region);

  const Plan& plan_;
  const WindowSchedule& schedule_;
  SplatSetting setting_;
  std::vector<SweepGroups> groups_;  // of each sweep
  std::size_t bytes_per_leaf_;       // of all sums
  std::deque<WindowSums> parts_;     // that overlapping windows share
  std::size_t first_part_ = 0;       // of those
  std::size_t frames_ = 0;           // of the first sweep, where blocks grow
  std::optional<WindowSums> sums_;   // of the window
  std::optional<MomentMeans> means_;
};

}  // namespace grainvdb
