#pragma once
/// The frames of all dump files of one kind, particles or contacts of either sort, in ascending order of step.
#include <cstddef>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "read/dump_file.hpp"
#include "read/file_list.hpp"
#include "read/formats.hpp"

namespace grainvdb {

/// One frame of the index.
struct FrameRecord {
  std::size_t file = 0;  ///< in files()
  std::size_t index_in_file = 0;
  bool last_in_file = false;
  TextPosition start;
  std::int64_t step = 0;
  std::optional<double> time;
  std::size_t rows = 0;
  Box box;
  std::size_t columns = 0;  ///< in column_sets()
  std::size_t columns_line = 0;
};

/// A text and where it stands.
struct Stated {
  std::string text;
  Location where;
};

class DumpSeries {
 public:
  /// Opens nothing. `spec` and `counters` must outlive the series.
  DumpSeries(std::vector<InputFile> files, RowKind kind, const InputSpec& spec, ReadCounters& counters);

  /// Opens every file and notes its frames. A file is taken to hold one frame, and only its header is read, when a file
  /// of the same columns and compression was read through and held one frame, and this one has at most 1.25 times as
  /// many bytes per row; read_rows finds out should that ever be wrong. Files met in a directory that are no dumps of
  /// this kind are left out of files(). Of files that may still be written to only the frames that are complete are
  /// noted; those behind a file that grows wait for it, and a file that has settled before one with frames is
  /// taken as it is. Throws InputError: a step twice, units in conflict and, unless such frames are
  /// to be skipped, no dump, malformed headers.
  void build_index();
  bool indexed() const { return indexed_; }

  const std::vector<InputFile>& files() const { return files_; }
  const std::vector<FrameRecord>& frames() const { return frames_; }
  /// Files, or the rest of files, that the index leaves out for their faults.
  const std::vector<BadFrame>& unreadable() const { return unreadable_; }
  /// Files that settled and were found complete.
  const std::vector<FileIdentity>& whole_files() const { return whole_files_; }
  /// What is wrong with a file that has settled before one with frames; nullptr where nothing is.
  const std::exception_ptr& fault() const { return fault_; }
  const std::vector<std::string>& columns(const FrameRecord& frame) const { return column_sets_[frame.columns]; }
  /// What the index knows of a frame's header.
  FrameHeader header(const FrameRecord& frame) const;
  /// Unit system named in the dumps, if any.
  const std::optional<Stated>& units() const { return units_; }
  /// The frame of a step, if there is one.
  std::optional<std::size_t> find(std::int64_t step) const;
  /// The columns of the first frame of the first file; opens that file only. Empty when there are no files.
  std::vector<std::string> first_columns();

  /// Goes to frame k and reads its header; then its rows.
  const FrameHeader& go_to(std::size_t k);
  DumpTable read_rows(const TableRequest& request);

 private:
  /// Files of the same columns and compression have about the same bytes per row.
  using FileClass = std::pair<std::size_t, Compression>;

  bool open(std::size_t file);
  bool is_wanted(const FrameHeader& header) const;
  std::optional<FrameHeader> next_header();
  template <class Read>
  bool attempt(const InputFile& input, Read read);
  void add_frame(std::size_t file, std::size_t index_in_file, const FrameHeader& header);
  bool index_complete_frames(std::size_t file);
  bool end_pending(std::size_t file, std::map<FileClass, double>& bytes_per_row);
  void index_file(std::size_t file, std::map<FileClass, double>& bytes_per_row);
  void note_units(const FrameHeader& header, const std::string& path);
  std::size_t column_set(const std::vector<std::string>& columns);
  void refuse_kind(const FrameHeader& header, const std::string& path) const;
  void sort_frames();

  std::vector<InputFile> files_;
  RowKind kind_;
  const InputSpec& spec_;
  ReadCounters& counters_;
  std::vector<FrameRecord> frames_;
  std::vector<BadFrame> unreadable_;
  std::vector<FileIdentity> whole_files_;
  std::exception_ptr fault_;
  std::vector<std::vector<std::string>> column_sets_;
  std::optional<Stated> units_;
  bool indexed_ = false;

  std::optional<std::size_t> open_file_;  ///< the file that dump_ reads
  OpenedDump dump_;
  FrameHeader header_;       ///< of the frame gone to
  std::size_t current_ = 0;  ///< the frame gone to
};

}  // namespace grainvdb
