#include "cli/report.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

#include "cli/peak_memory.hpp"
#include "grainvdb/mask.hpp"
#include "pipeline/number.hpp"

namespace grainvdb::cli {
namespace {

std::string meaning(const std::string& name) {
  const auto it = std::find_if(reasons().begin(), reasons().end(), [&](const ReasonInfo& r) { return r.name == name; });
  return it == reasons().end() ? std::string() : " (" + std::string(it->meaning) + ')';
}

std::string counted(std::size_t n, const char* noun) {
  return std::to_string(n) + ' ' + noun + (n == 1 ? "" : "s");
}

// The first file with the ending; empty when there is none.
std::string file_ending_in(const std::vector<std::string>& files, const char* ending) {
  const auto it = std::find_if(files.begin(), files.end(), [&](const std::string& f) { return f.ends_with(ending); });
  return it == files.end() ? std::string() : *it;
}

std::string files_written(const std::vector<std::string>& files) {
  constexpr std::size_t shown = 4;  // a series may have one file per output time
  std::string text;
  for (std::size_t i = 0; i < std::min(shown, files.size()); ++i) text += "wrote " + files[i] + '\n';
  if (files.size() > shown) text += "and " + counted(files.size() - shown, "more file") + " beside them\n";
  const std::string hdf5 = file_ending_in(files, ".hdf"), series = file_ending_in(files, ".xmf2");
  if (hdf5.empty()) return text;
  return text + "look at it:\n  paraview " + (series.empty() ? hdf5 : series) +
         "\n  python3 -c \"import h5py; print(list(h5py.File('" + hdf5 + "')['VTKHDF/PointData']))\"\n";
}

std::string describe_trace(const TraceReport& trace) {
  std::string text;
  for (const std::string& line : grainvdb::describe(trace))
    if (line != trace_warning(trace)) text += "trace: " + line + '\n';
  text += files_written(trace.files);
  const std::string h5md = file_ending_in(trace.files, ".h5"), sidecar = file_ending_in(trace.files, ".xmf2");
  if (h5md.empty()) return text;
  return text + "look at them:\n  paraview " + sidecar + "\n  python3 -c \"import h5py; print(list(h5py.File('" + h5md +
         "')['particles/tracers']))\"\n";
}

/// Numbers are shortened: the tables have them whole.
std::string describe_table(const Table& table) {
  std::string text = "table " + table.name;
  if (!table.columns.empty()) text += ": " + counted(table.columns.front().values.size(), "row");
  text += '\n';
  for (const Quantity& q : table.numbers) {
    text += "  " + q.name + ' ' + short_number(q.value);
    if (!std::isnan(q.error)) text += " +- " + short_number(q.error);
    text += (q.unit == "1" ? "" : ' ' + q.unit) + "  (" + q.description + ")\n";
  }
  for (const std::string& remark : table.remarks) text += "  note: " + remark + '\n';
  return text;
}

std::string warnings_of_input(const RunReport& report) {
  constexpr std::size_t shown = 10;
  std::string text;
  const std::size_t n = report.bad_frames.size();
  for (std::size_t i = 0; i < std::min(shown, n); ++i)
    text += "grainvdb: warning: left out " + to_string(report.bad_frames[i]) + '\n';
  if (n > shown)
    text += "grainvdb: warning: left out " + counted(n - shown, "more bad frame") +
            ", which the result lists in /provenance/bad_frames\n";
  return text;
}

std::string warnings_of_results(const RunReport& report, const std::string& where) {
  std::string text;
  if (report.narrow_kernel)
    text += "grainvdb: warning: " + where + "the kernel's cutoff is " +
            short_number(report.narrow_kernel->in_diameters) +
            " mean diameters, less than limits.cutoff_in_diameters = " + short_number(report.narrow_kernel->least) +
            ": fields show single grains, not a continuum; three diameters are usual (kernel.cutoff)\n";
  if (report.stop && !report.stop->met)
    text += "grainvdb: warning: " + where + "average.until was not met after all " +
            counted(report.stop->frames, "frame") + '\n';
  if (report.trace && !report.trace->is_meaningful())
    text += "grainvdb: warning: " + where + trace_warning(*report.trace) + '\n';
  return text;
}

}  // namespace

std::string warnings(const RunReport& report) {
  return warnings_of_input(report) + warnings_of_results(report, {});
}

std::string warnings(const std::vector<RunReport>& reports, const std::vector<std::string>& names) {
  std::string text = warnings_of_input(reports.front());
  for (std::size_t n = 0; n < reports.size(); ++n) text += warnings_of_results(reports[n], "at " + names[n] + ": ");
  return text;
}

std::string scale_name(const Pipeline& pipeline) {
  return "cutoff " + print_number(pipeline.cutoff) + ", voxel " + print_number(pipeline.voxel);
}

std::string describe(const RunReport& report) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(2);
  text << counted(report.frames, "frame");
  if (report.channels > 0)
    text << ", " << counted(report.active_voxels, "active voxel") << ", " << counted(report.channels, "channel")
         << " splatted per frame";
  text << '\n';
  if (report.resumed_at > 0) text << "resumed: " << counted(report.resumed_at, "frame") << " had been done before\n";
  if (!report.bad_frames.empty()) text << "left out: " << counted(report.bad_frames.size(), "bad frame") << '\n';
  for (const std::string& line : report.averaging) text << "average: " << line << '\n';
  text << "time: " << report.wall_seconds << " s; by step, which overlap:";
  const char* between = " ";
  for (const auto& [step, seconds] : report.seconds) {
    text << between << step << ' ' << seconds << " s";
    between = ", ";
  }
  text << '\n';
  text << "memory: " << peak_memory() / 1e6 << " MB at most";
  if (report.memory > 0) text << ", " << report.memory / 1e6 << " MB by the formula of 'grainvdb graph'";
  text << '\n';
  text << "read: " << counted(report.read.files_opened.size(), "file") << ", " << counted(report.read.rows_read, "row")
       << ", " << static_cast<double>(report.read.bytes_read) / 1e6 << " MB\n";
  for (const auto& [reason, count] : report.masked)
    text << "mask: " << counted(count, "voxel") << ' ' << reason << meaning(reason) << '\n';
  for (const Table& table : report.tables) text << describe_table(table);
  text << files_written(report.files);
  if (report.trace) text << describe_trace(*report.trace);
  return text.str();
}

}  // namespace grainvdb::cli
