#include "grainvdb/run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "grainvdb/version.hpp"
#include "pipeline/derive_fields.hpp"
#include "pipeline/stopwatch.hpp"
#include "pipeline/window.hpp"

namespace grainvdb {
namespace {

/// The voxels that the kernels can reach from a box: fixed for all output times of a series. Particles leave an open
/// box until its bounds are next updated or they are removed: there is room for one cutoff beyond it, then for the
/// kernel.
Topology::Bounds reach_of_boxes(const Lattice& lattice, const FrameSource& source, std::span<const std::size_t> wanted,
                                double cutoff) {
  Coord first;
  Coord last;
  std::int32_t* const firsts[] = {&first.x, &first.y, &first.z};
  std::int32_t* const lasts[] = {&last.x, &last.y, &last.z};
  for (int a = 0; a < 3; ++a) {
    if (const auto& period = lattice.period(a)) {
      *firsts[a] = period->first;
      *lasts[a] = period->first + period->count - 1;
      continue;
    }
    const auto axis = static_cast<std::size_t>(a);
    double lo = source.frames()[wanted.front()].box.lo[axis];
    double hi = source.frames()[wanted.front()].box.hi[axis];
    for (std::size_t k : wanted) {
      lo = std::min(lo, source.frames()[k].box.lo[axis]);
      hi = std::max(hi, source.frames()[k].box.hi[axis]);
    }
    *firsts[a] = static_cast<std::int32_t>(std::floor(lattice.to_index(a, lo - 2 * cutoff)));
    *lasts[a] = static_cast<std::int32_t>(std::ceil(lattice.to_index(a, hi + 2 * cutoff)));
  }
  return {first, last};
}

void check_dense_size(const Topology::Bounds& bounds, const Pipeline& pipeline) {
  double voxels = 1;
  for (int a = 0; a < 3; ++a) voxels *= 1.0 + bounds.last[a] - bounds.first[a];
  if (voxels <= static_cast<double>(pipeline.limits.dense_voxels)) return;
  throw LimitError({pipeline.location("limits.dense_voxels"), "the box to be written has too many voxels",
                    std::to_string(static_cast<long long>(voxels)),
                    "at most limits.dense_voxels = " + std::to_string(pipeline.limits.dense_voxels),
                    "Choose larger voxels, leave stray particles out with select, or raise the limit"});
}

/// Fields that can be undefined, or are made of such fields, are written with the reasons.
bool writes_mask(const Plan& plan) {
  return std::any_of(plan.stages.begin(), plan.stages.end(),
                     [](const Stage* s) { return !s->additive || !s->compute; });
}

std::vector<const SparseField*> wanted_fields(const Pipeline& pipeline, const DerivedFields& derived) {
  std::vector<const SparseField*> fields;
  for (const std::string& name : pipeline.fields)
    if (const auto it = derived.fields.find(name); it != derived.fields.end()) fields.push_back(&it->second);
  return fields;
}

template <class Range, class F>
std::string lines(const Range& range, F&& line) {
  std::string text;
  for (const auto& item : range) text += line(item) + "\n";
  return text;
}

Provenance provenance_of(const Pipeline& pipeline, const Plan& plan, const FrameSource& source,
                         std::span<const std::size_t> wanted) {
  const auto plain = [](const auto& s) { return s; };
  std::vector<std::size_t> skipped;
  for (std::size_t k = 0; k < source.frames().size(); ++k)
    if (!std::binary_search(wanted.begin(), wanted.end(), k)) skipped.push_back(k);
  const auto step = [&](std::size_t k) { return std::to_string(source.frames()[k].step); };
  std::set<std::string> columns;
  for (const Sweep& sweep : plan.sweeps)
    for (const std::string& name : column_names(sweep.columns)) columns.insert(name);
  return {{"version", GRAINVDB_VERSION},
          {"pipeline", pipeline.resolved},
          {"inputs", lines(source.files(), [](const auto& f) { return f.first + " " + std::to_string(f.second); })},
          {"units", source.units().name},
          {"steps", lines(wanted, step)},
          {"skipped_frames", lines(skipped, step)},
          {"columns_read", lines(columns, plain)},
          {"computed", lines(plan.stages, [](const Stage* s) { return s->name + ": " + s->equation; })},
          {"not_needed", lines(plan.not_needed, plain)}};
}

OutputLayout layout_of(const Plan& plan, const FrameSource& source, const Lattice& lattice,
                       const Topology::Bounds& bounds, std::size_t times,
                       const std::vector<const SparseField*>& fields) {
  OutputLayout layout(lattice);
  layout.first = bounds.first;
  layout.last = bounds.last;
  layout.time_count = times;
  for (const SparseField* f : fields) layout.fields.push_back(f->meta());
  layout.has_mask = writes_mask(plan);
  layout.length_unit = source.units().length;
  layout.time_unit = source.frames().front().time ? source.units().time : "step";
  return layout;
}

[[noreturn]] void refuse_without_material(const FrameSource& source, std::span<const std::size_t> wanted) {
  throw InputError({{source.frames()[wanted.front()].file, 0},
                    "no material in any of the frames",
                    {},
                    "at least one particle that select keeps",
                    "Check select and frames"});
}

std::size_t channel_count(const Plan& plan) {
  std::size_t n = 0;
  for (const Sweep& sweep : plan.sweeps)
    for (const auto& pass : sweep.passes)
      for (const MomentPtr& m : pass) n += static_cast<std::size_t>(m->channels);
  return n;
}

}  // namespace

RunReport run_pipeline(const Pipeline& pipeline, const Plan& plan, FrameSource& source,
                       const std::vector<std::unique_ptr<FieldSink>>& sinks,
                       const std::function<void(const Progress&)>& progress) {
  const Lattice lattice = check_against_input(pipeline, plan, source);
  const std::vector<std::size_t> wanted = select_frames(pipeline.frames, source.frames().size());
  const std::size_t per_window = pipeline.window == 0 ? wanted.size() : std::min(pipeline.window, wanted.size());
  const std::size_t windows = (wanted.size() + per_window - 1) / per_window;

  std::optional<Topology::Bounds> bounds;
  if (windows > 1) {
    bounds = reach_of_boxes(lattice, source, wanted, pipeline.cutoff);
    check_dense_size(*bounds, pipeline);
  }

  RunReport report;
  report.channels = channel_count(plan);
  Stopwatch clock;
  Progress now{0, wanted.size() * plan.sweeps.size(), {}};
  const auto frame_done = [&](std::size_t sweep) {
    ++now.frames_done;
    now.doing = plan.sweeps.size() > 1
                    ? "sweep " + std::to_string(sweep + 1) + " of " + std::to_string(plan.sweeps.size())
                    : "frames";
    if (progress) progress(now);
  };

  std::size_t material = 0;
  for (std::size_t w = 0; w < windows; ++w) {
    const std::size_t first = w * per_window;
    const auto frames = std::span(wanted).subspan(first, std::min(per_window, wanted.size() - first));
    const WindowMoments moments = average_window(pipeline, plan, lattice, source, frames, clock, frame_done);
    material += moments.material;
    const DerivedFields derived =
        clock.time("derive", [&] { return derive_fields(pipeline, plan, lattice, source.units(), moments.means); });
    const std::vector<const SparseField*> fields = wanted_fields(pipeline, derived);

    clock.time("write", [&] {
      if (w == 0) {
        if (!bounds) bounds = moments.means.topology()->bounds();
        if (!bounds) refuse_without_material(source, wanted);
        check_dense_size(*bounds, pipeline);
        for (const auto& sink : sinks) sink->begin(layout_of(plan, source, lattice, *bounds, windows, fields));
      }
      const Mask* mask = writes_mask(plan) ? &derived.mask : nullptr;
      for (const auto& sink : sinks) sink->write(moments.time, fields, mask);
    });

    report.active_voxels = moments.means.topology()->active_voxel_count();
    report.grids += derived.grids;
    report.masked.clear();
    for (const ReasonInfo& r : reasons())
      if (const std::size_t n = derived.mask.count(r.reason); n > 0) report.masked.emplace_back(r.name, n);
  }

  if (material == 0) refuse_without_material(source, wanted);  // contacts alone leave every other field undefined

  clock.time("write", [&] {
    for (const auto& sink : sinks) {
      sink->commit(provenance_of(pipeline, plan, source, wanted));
      for (const std::string& file : sink->files()) report.files.push_back(file);
    }
  });
  report.frames = wanted.size();
  report.seconds = clock.seconds();
  report.read = source.counters();
  return report;
}

}  // namespace grainvdb
