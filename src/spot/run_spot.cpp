#include "spot/run_spot.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "grainvdb/error.hpp"
#include "pipeline/number.hpp"
#include "spot/snapshot.hpp"
#include "spot/void_frame.hpp"
#include "write/text_file.hpp"

namespace grainvdb::spot {
namespace {

std::string dump_name(std::size_t k) {
  std::string digits = std::to_string(k);
  if (digits.size() < 7) digits.insert(0, 7 - digits.size(), '0');
  return "spot_" + digits + ".dump";
}

/// The spot model from snapshot to snapshot.
class SpotFrames {
 public:
  explicit SpotFrames(const SpotRun& run) : model_(run.container, run.packing, run.parameters, run.seed) {}

  DumpFrame next(double time) {
    model_.advance(time);
    model_.compact();
    Snapshot now = take_snapshot(model_);
    DumpFrame frame = make_frame(model_, now, velocities(before_, now, model_.particles().unit()));
    before_ = std::move(now);
    return frame;
  }
  double time() const { return model_.time(); }
  const std::vector<Drained>& drained() const { return model_.drained(); }
  SpotCounters counters() const { return model_.counters(); }

 private:
  SpotModel model_;
  Snapshot before_;
};

/// The void model from snapshot to snapshot.
class VoidFrames {
 public:
  explicit VoidFrames(const SpotRun& run)
      : model_(run.container, run.voids->lattice, run.voids->parameters, run.seed),
        box_(run.container.box),
        diameter_(run.packing.diameter) {}

  DumpFrame next(double time) {
    model_.advance(time);
    return before_ = make_frame(model_, box_, diameter_, before_);
  }
  double time() const { return model_.time(); }
  const std::vector<Drained>& drained() const { return model_.drained(); }
  SpotCounters counters() const {
    const VoidCounters& c = model_.counters();
    return {c.hops, 0, c.inserted, c.removed, c.hops};
  }

 private:
  LatticeVoids model_;
  Box box_;
  double diameter_;
  DumpFrame before_;
};

/// The number of the first snapshot after that of the start.
std::size_t first_after_start(const SpotRun& run) {
  const double intervals = run.from / run.interval * (1 - 1e-12);
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(intervals)));
}

std::size_t last_snapshot(const SpotRun& run) {
  return static_cast<std::size_t>(std::floor(run.end / run.interval * (1 + 1e-12)));
}

template <class Frames>
SpotReport write_frames(const SpotRun& run, Frames frames, const std::filesystem::path& folder,
                        const std::function<void(std::size_t, std::size_t)>& progress) {
  SpotReport report;
  report.particles_at_start = run.packing.id.size();
  const std::size_t first = first_after_start(run);
  const std::size_t last = last_snapshot(run);
  for (std::size_t k = 0; k <= last; ++k) {
    const DumpFrame frame = frames.next(static_cast<double>(k) * run.interval);
    if (k == 0 || k >= first) {
      write_text_file((folder / dump_name(k)).string(), dump_text(frame, static_cast<std::int64_t>(k), run.units));
      ++report.snapshots;
    }
    report.particles_at_end = frame.id.size();
    if (progress) progress(k + 1, last + 1);
    if (frame.id.empty()) break;
  }
  std::string drained;
  for (const Drained& d : frames.drained()) drained += std::to_string(d.id) + ' ' + print_number(d.time) + '\n';
  write_text_file((folder / "drained.txt").string(), drained);
  write_text_file((folder / "spot.yaml").string(), run.resolved);
  report.drained = frames.drained().size();
  report.time = frames.time();
  report.counters = frames.counters();
  return report;
}

}  // namespace

void refuse_used_folder(const std::string& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("spot_") && name.ends_with(".dump"))
      throw ConfigError(
          {{folder}, "the folder holds dumps of another spot run", name, {}, "Take another folder, or remove them"});
  }
}

std::size_t most_snapshots(const SpotRun& run) {
  return 1 + last_snapshot(run) - std::min(first_after_start(run) - 1, last_snapshot(run));
}

SpotReport run_spot(const SpotRun& run, const std::string& folder,
                    const std::function<void(std::size_t, std::size_t)>& progress) {
  refuse_used_folder(folder);
  return run.voids ? write_frames(run, VoidFrames(run), folder, progress)
                   : write_frames(run, SpotFrames(run), folder, progress);
}

}  // namespace grainvdb::spot
