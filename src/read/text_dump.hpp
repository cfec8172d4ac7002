#pragma once
/// LAMMPS and LIGGGHTS text dumps (`dump atom`, `dump custom`, `dump local`): sections that begin with "ITEM:".
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "read/dump_file.hpp"

namespace grainvdb {

class TextDump final : public DumpFile {
 public:
  explicit TextDump(LineReader lines) : lines_(std::move(lines)) {}

  static bool recognise(std::string_view head);
  static std::unique_ptr<DumpFile> open(std::unique_ptr<ByteStream> bytes, const std::string& file);

  std::optional<FrameHeader> next_header() override;
  bool skip_rows() override;
  DumpTable read_rows(const TableRequest& request) override;
  bool at_end() override { return lines_.at_end(); }
  void seek(const TextPosition& start) override { lines_.seek(start); }

 private:
  bool skip_one_by_one(std::size_t count, std::size_t& left);
  void check_end_of_rows();
  [[noreturn]] void fail(const std::string& what, const std::string& found, const std::string& expected,
                         const std::string& hint = {}) const;

  LineReader lines_;
  FrameHeader header_;  ///< of the frame whose rows come next
  std::string label_;   ///< what this frame calls its rows: ATOMS, ENTRIES, …
};

}  // namespace grainvdb
