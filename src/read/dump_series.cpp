#include "read/dump_series.hpp"

#include <algorithm>

#include "grainvdb/error.hpp"
#include "read/text.hpp"
#include "read/unsaid.hpp"

namespace grainvdb {
namespace {

/// How many times as many bytes per row a file may have as one of its kind that is known to hold one frame.
constexpr double spread = 1.25;
/// Smaller files are read through whatever they hold: it costs no more than their header.
constexpr std::uintmax_t small_file = std::uintmax_t{1} << 14;

const char* plural(RowKind kind) {
  switch (kind) {
    case RowKind::particles:
      return "particles";
    case RowKind::contacts:
      return "contacts";
    case RowKind::wall_contacts:
      return "contacts with walls";
  }
  return "";
}

}  // namespace

DumpSeries::DumpSeries(std::vector<InputFile> files, RowKind kind, const InputSpec& spec, ReadCounters& counters)
    : files_(std::move(files)), kind_(kind), spec_(spec), counters_(counters) {}

/// Opens a file in place of the one that is open. False when its format is not recognised.
bool DumpSeries::open(std::size_t file) {
  open_file_.reset();
  dump_ = open_dump(files_[file].path, counters_);
  if (!dump_.dump) return false;
  dump_.dump->choose(kind_);
  open_file_ = file;
  return true;
}

/// Text dumps do not say that their contacts are with walls.
bool DumpSeries::is_wanted(const FrameHeader& header) const {
  return header.kind == kind_ || (kind_ == RowKind::wall_contacts && header.kind == RowKind::contacts);
}

/// The next header of the open file, with what the input says in its place.
std::optional<FrameHeader> DumpSeries::next_header() {
  std::optional<FrameHeader> header = dump_.dump->next_header();
  if (header) complete(*header, spec_, files_[*open_file_].path);
  return header;
}

void DumpSeries::build_index() {
  if (indexed_) return;
  frames_.clear();
  unreadable_.clear();
  std::map<FileClass, double> bytes_per_row;
  std::vector<std::size_t> pending;
  std::size_t last_with_frames = 0;
  for (std::size_t file = 0; file < files_.size(); ++file) {
    const std::size_t before = frames_.size();
    if (files_[file].state == InputFile::State::settled || files_[file].state == InputFile::State::growing) {
      if (!index_complete_frames(file)) pending.push_back(file);
    } else {
      index_file(file, bytes_per_row);
    }
    if (frames_.size() > before) last_with_frames = file;
  }
  for (const std::size_t file : pending)
    if (file >= last_with_frames || !end_pending(file, bytes_per_row)) break;
  open_file_.reset();
  dump_ = {};

  std::vector<bool> used(files_.size(), false);
  for (const FrameRecord& frame : frames_) used[frame.file] = true;
  std::vector<std::size_t> new_number(files_.size());
  std::vector<InputFile> kept;
  for (std::size_t file = 0; file < files_.size(); ++file) {
    new_number[file] = kept.size();
    if (used[file]) kept.push_back(files_[file]);
  }
  for (FrameRecord& frame : frames_) frame.file = new_number[frame.file];
  files_ = std::move(kept);
  sort_frames();
  indexed_ = true;
}

/// False when it threw an InputError and the file is to be left out from here on.
template <class Read>
bool DumpSeries::attempt(const InputFile& input, Read read) {
  if (spec_.on_error == OnError::error) {
    read();
    return true;
  }
  try {
    read();
    return true;
  } catch (const InputError& error) {
    unreadable_.push_back({input.path, {}, error.what()});
    return false;
  }
}

void DumpSeries::add_frame(std::size_t file, std::size_t index_in_file, const FrameHeader& header) {
  frames_.push_back({file, index_in_file, false, header.start, header.step, header.time, header.rows, header.box,
                     column_set(header.columns), header.columns_line});
}

/// Of a file that may still be written to: what is malformed is on its way. False where more of it must come.
bool DumpSeries::index_complete_frames(std::size_t file) {
  const InputFile& input = files_[file];
  std::size_t count = 0;
  try {
    if (!open(file)) return !input.named;
    std::optional<FrameHeader> header = next_header();
    while (header && is_wanted(*header) && dump_.dump->skip_rows()) {
      const bool is_last = dump_.dump->at_end();
      if (is_last && input.state == InputFile::State::growing) return false;
      note_units(*header, input.path);
      add_frame(file, count++, *header);
      if (is_last) {
        whole_files_.push_back(input.identity);
        return true;
      }
      header = next_header();
    }
    return header && !is_wanted(*header) && !input.named;
  } catch (const InputError&) {
    return false;
  }
}

/// Of a file that is not complete though one behind it has frames. Where it has settled nothing more will come: it is
/// what it is. Else what is behind it waits for it, and the result is false.
bool DumpSeries::end_pending(std::size_t file, std::map<FileClass, double>& bytes_per_row) {
  if (files_[file].state == InputFile::State::growing) {
    std::erase_if(frames_, [&](const FrameRecord& frame) { return frame.file > file; });
    return false;
  }
  std::erase_if(frames_, [&](const FrameRecord& frame) { return frame.file == file; });
  try {
    index_file(file, bytes_per_row);
  } catch (const InputError&) {
    if (!fault_) fault_ = std::current_exception();
  }
  return true;
}

void DumpSeries::index_file(std::size_t file, std::map<FileClass, double>& bytes_per_row) {
  const InputFile& input = files_[file];
  const bool opened = attempt(input, [&] {
    if (!open(file) && input.named) refuse_unrecognised(input.path, dump_);
  });
  if (!opened || open_file_ != file) return;
  std::optional<FileClass> file_class;
  std::size_t count = 0;
  bool whole = true;
  std::optional<FrameHeader> header;
  while (attempt(input, [&] { header = next_header(); }) && header) {
    if (!is_wanted(*header)) {
      if (input.named) refuse_kind(*header, input.path);
      return;
    }
    note_units(*header, input.path);
    add_frame(file, count++, *header);
    const std::size_t columns = frames_.back().columns;
    if (count == 1) {
      file_class = FileClass{columns, dump_.compression};
      const auto known = bytes_per_row.find(*file_class);
      if (input.size > small_file && known != bytes_per_row.end() &&
          static_cast<double>(input.size) <= spread * known->second * static_cast<double>(header->rows)) {
        frames_.back().last_in_file = input.state == InputFile::State::fixed;
        return;
      }
    }
    // Missing rows are an error only for those who read the frame.
    if (!attempt(input, [&] { whole = dump_.dump->skip_rows() && whole; })) break;
  }
  if (count == 0) return;
  frames_.back().last_in_file = input.state == InputFile::State::fixed;
  const std::size_t rows = frames_.back().rows;
  if (count == 1 && whole && rows > 0) {
    double& most = bytes_per_row[*file_class];
    most = std::max(most, static_cast<double>(input.size) / static_cast<double>(rows));
  }
}

void DumpSeries::note_units(const FrameHeader& header, const std::string& path) {
  if (!header.units) return;
  const Location here{path, header.units_line};
  if (!units_)
    units_ = Stated{*header.units, here};
  else if (units_->text != *header.units)
    throw InputError({here,
                      "the units are not those of the other dumps",
                      in_quotes(*header.units),
                      in_quotes(units_->text) + ", as in " + to_string(units_->where),
                      {}});
}

std::size_t DumpSeries::column_set(const std::vector<std::string>& columns) {
  const auto it = std::find(column_sets_.begin(), column_sets_.end(), columns);
  if (it != column_sets_.end()) return static_cast<std::size_t>(it - column_sets_.begin());
  column_sets_.push_back(columns);
  return column_sets_.size() - 1;
}

void DumpSeries::refuse_kind(const FrameHeader& header, const std::string& path) const {
  throw InputError({{path, header.columns_line},
                    std::string("a dump of ") + plural(header.kind) + " is listed among the " + plural(kind_),
                    {},
                    std::string("a dump of ") + plural(kind_),
                    "Correct the paths or globs of the input"});
}

void DumpSeries::sort_frames() {
  std::stable_sort(frames_.begin(), frames_.end(),
                   [](const FrameRecord& a, const FrameRecord& b) { return a.step < b.step; });
  const auto twice = std::adjacent_find(frames_.begin(), frames_.end(),
                                        [](const FrameRecord& a, const FrameRecord& b) { return a.step == b.step; });
  if (twice == frames_.end()) return;
  const Location first{files_[twice->file].path, twice->start.line};
  const Location second{files_[(twice + 1)->file].path, (twice + 1)->start.line};
  throw InputError({second, "timestep " + std::to_string(twice->step) + " comes twice",
                    "it also in " + to_string(first), "each timestep once", "Correct the paths or globs of the input"});
}

FrameHeader DumpSeries::header(const FrameRecord& frame) const {
  FrameHeader header;
  header.start = frame.start;
  header.step = frame.step;
  header.time = frame.time;
  header.box = frame.box;
  header.kind = kind_;
  header.rows = frame.rows;
  header.columns = columns(frame);
  header.columns_line = frame.columns_line;
  return header;
}

std::optional<std::size_t> DumpSeries::find(std::int64_t step) const {
  const auto it = std::lower_bound(frames_.begin(), frames_.end(), step,
                                   [](const FrameRecord& frame, std::int64_t s) { return frame.step < s; });
  if (it == frames_.end() || it->step != step) return std::nullopt;
  return static_cast<std::size_t>(it - frames_.begin());
}

std::vector<std::string> DumpSeries::first_columns() {
  for (std::size_t file = 0; file < files_.size(); ++file) {
    if (!open(file)) {
      if (files_[file].named) refuse_unrecognised(files_[file].path, dump_);
      continue;
    }
    const std::optional<FrameHeader> header = next_header();
    if (header && is_wanted(*header)) return header->columns;
    if (header && files_[file].named) refuse_kind(*header, files_[file].path);
  }
  return {};
}

const FrameHeader& DumpSeries::go_to(std::size_t k) {
  const FrameRecord& frame = frames_[k];
  const std::string& path = files_[frame.file].path;
  if (open_file_ != frame.file && !open(frame.file)) refuse_unrecognised(path, dump_);
  dump_.dump->seek(frame.start);
  std::optional<FrameHeader> header = next_header();
  if (!header || header->step != frame.step || header->rows != frame.rows || !is_wanted(*header))
    throw InputError({{path, frame.start.line},
                      "the file has changed since it was indexed",
                      {},
                      "the frame of timestep " + std::to_string(frame.step),
                      {}});
  header_ = std::move(*header);
  current_ = k;
  return header_;
}

DumpTable DumpSeries::read_rows(const TableRequest& request) {
  const FrameRecord& frame = frames_[current_];
  DumpTable table = dump_.dump->read_rows(request);
  if (frame.last_in_file && !dump_.dump->at_end())
    throw InputError({{files_[frame.file].path, table.first_line + table.rows},
                      "the file holds another frame, much smaller than its first",
                      {},
                      "one frame, as in the other files of the input",
                      "Split the file"});
  const auto note = [&](std::size_t column) { counters_.columns_parsed.insert(header_.columns[column]); };
  std::for_each(request.real.begin(), request.real.end(), note);
  std::for_each(request.whole.begin(), request.whole.end(), note);
  counters_.rows_read += table.rows;
  return table;
}

}  // namespace grainvdb
