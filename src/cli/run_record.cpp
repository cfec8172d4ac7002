#include "cli/run_record.hpp"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "cli/peak_memory.hpp"
#include "grainvdb/version.hpp"
#include "write/text_file.hpp"

namespace grainvdb::cli {

void write_run_record(const RunReport& report, const std::string& folder) {
  nlohmann::ordered_json steps;
  for (const auto& [step, seconds] : report.seconds) steps[step] = seconds;
  const nlohmann::ordered_json record{{"grainvdb", GRAINVDB_VERSION},          {"frames", report.frames},
                                      {"active_voxels", report.active_voxels}, {"bytes_read", report.read.bytes_read},
                                      {"wall_seconds", report.wall_seconds},   {"seconds_by_step", steps},
                                      {"peak_memory_bytes", peak_memory()}};
  write_text_file((std::filesystem::path(folder) / "run.json").string(), record.dump(2) + '\n');
}

}  // namespace grainvdb::cli
