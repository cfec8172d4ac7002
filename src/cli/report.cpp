#include "cli/report.hpp"

#include <algorithm>
#include <iomanip>
#include <locale>
#include <sstream>

#include "grainvdb/mask.hpp"

namespace grainvdb::cli {
namespace {

std::string meaning(const std::string& name) {
  const auto it = std::find_if(reasons().begin(), reasons().end(), [&](const ReasonInfo& r) { return r.name == name; });
  return it == reasons().end() ? std::string() : " (" + std::string(it->meaning) + ')';
}

}  // namespace

std::string describe(const RunReport& report) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(2);
  text << report.frames << (report.frames == 1 ? " frame, " : " frames, ") << report.active_voxels << " active voxels, "
       << report.channels << " channels splatted per frame\n";
  double total = 0;
  text << "time:";
  for (const auto& [step, seconds] : report.seconds) {
    text << ' ' << step << ' ' << seconds << " s,";
    total += seconds;
  }
  text << " in all " << total << " s\n";
  text << "read: " << report.read.files_opened.size() << " files, " << report.read.rows_read << " rows, "
       << static_cast<double>(report.read.bytes_read) / 1e6 << " MB\n";
  for (const auto& [reason, count] : report.masked)
    text << "masked: " << count << " voxels " << reason << meaning(reason) << '\n';
  for (const std::string& file : report.files) text << "wrote " << file << '\n';
  for (const std::string& file : report.files)
    if (file.ends_with(".hdf"))
      text << "look at it:\n  paraview " << file << "\n  python3 -c \"import h5py; print(list(h5py.File('" << file
           << "')['VTKHDF/PointData']))\"\n";
  return text.str();
}

}  // namespace grainvdb::cli
