#include "pipeline/window.hpp"

#include <optional>
#include <set>
#include <string>

#include "pipeline/frame_context.hpp"

namespace grainvdb {
namespace {

OutputTime time_of(const FrameSource& source, std::span<const std::size_t> wanted) {
  OutputTime t;
  t.first_step = source.frames()[wanted.front()].step;
  t.last_step = source.frames()[wanted.back()].step;
  t.frame_count = wanted.size();
  for (std::size_t k : wanted) {
    const FrameInfo& frame = source.frames()[k];
    t.time += frame.time.value_or(static_cast<double>(frame.step)) / static_cast<double>(wanted.size());
  }
  return t;
}

/// Names of the moments that others of the same frame are made of.
std::set<std::string> needed_in_frame(const Sweep& sweep) {
  std::set<std::string> names;
  for (const auto& pass : sweep.passes)
    for (const MomentPtr& m : pass)
      for (const MomentPtr& need : m->frame_needs) names.insert(need->name);
  return names;
}

}  // namespace

WindowMoments average_window(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice, FrameSource& source,
                             std::span<const std::size_t> wanted, Stopwatch& clock,
                             const std::function<void(std::size_t)>& frame_done) {
  const LucyKernel kernel(pipeline.cutoff);
  MomentSums sums(plan.means);
  std::optional<MomentMeans> means;
  std::size_t material = 0;
  for (std::size_t s = 0; s < plan.sweeps.size(); ++s) {
    const Sweep& sweep = plan.sweeps[s];
    const std::set<std::string> kept = needed_in_frame(sweep);
    for (std::size_t k : wanted) {
      Frame frame = clock.time("read", [&] { return source.read(k, sweep.columns); });
      clock.time("splat", [&] {
        FrameContext context(std::move(frame), pipeline, lattice, kernel, kept, means ? &*means : nullptr);
        material += context.particles().size();
        for (const auto& pass : sweep.passes) context.run_pass(pass, sums);
        sums.end_frame();
      });
      frame_done(s);
    }
    clock.time("average", [&] {
      sums.end_sweep(wanted.size());
      means.emplace(sums.means());
    });
  }
  return {std::move(sums), std::move(*means), time_of(source, wanted), material};
}

}  // namespace grainvdb
