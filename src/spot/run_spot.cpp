#include "spot/run_spot.hpp"

#include <cmath>
#include <filesystem>

#include "grainvdb/error.hpp"
#include "pipeline/number.hpp"
#include "spot/snapshot.hpp"
#include "write/text_file.hpp"

namespace grainvdb::spot {
namespace {

std::string dump_name(std::size_t k) {
  std::string digits = std::to_string(k);
  if (digits.size() < 7) digits.insert(0, 7 - digits.size(), '0');
  return "spot_" + digits + ".dump";
}

// Dumps of another run would be read as one with those of this.
void refuse_used_folder(const std::string& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("spot_") && name.ends_with(".dump"))
      throw ConfigError(
          {{folder}, "the folder holds dumps of another spot run", name, {}, "Take another folder, or remove them"});
  }
}

}  // namespace

SpotReport run_spot(const SpotRun& run, const std::string& folder,
                    const std::function<void(std::size_t, std::size_t)>& progress) {
  refuse_used_folder(folder);
  SpotModel model(run.container, run.packing, run.parameters, run.seed);
  SpotReport report;
  report.particles_at_start = run.packing.id.size();
  const auto last = static_cast<std::size_t>(std::floor(run.end / run.interval * (1 + 1e-12)));
  Snapshot before;
  for (std::size_t k = 0; k <= last; ++k) {
    model.advance(static_cast<double>(k) * run.interval);
    model.compact();
    Snapshot now = take_snapshot(model);
    write_text_file((std::filesystem::path(folder) / dump_name(k)).string(),
               dump_text(model, now, velocities(before, now, model.particles().unit()), static_cast<std::int64_t>(k),
                         run.units));
    before = std::move(now);
    ++report.snapshots;
    if (progress) progress(k + 1, last + 1);
    if (model.particles().size() == 0) break;
  }
  std::string drained;
  for (const Drained& d : model.drained()) drained += std::to_string(d.id) + ' ' + print_number(d.time) + '\n';
  write_text_file((std::filesystem::path(folder) / "drained.txt").string(), drained);
  write_text_file((std::filesystem::path(folder) / "spot.yaml").string(), run.resolved);
  report.particles_at_end = model.particles().size();
  report.drained = model.drained().size();
  report.time = model.time();
  report.counters = model.counters();
  return report;
}

}  // namespace grainvdb::spot
