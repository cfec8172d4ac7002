#pragma once
/// MercuryDPM contact files (name.fstat): frames one after another, each three lines that begin with # and then lines
///
///   t  P  I  c (3)  overlap  tangential overlap  f_n  f_t  n (3)  t (3)
///
/// P and I are places of particles, counted from 0. The unit vector n points from I to P, and f_n n + f_t t is the
/// force that acts on P (BaseParticle::getInteractionWith, BaseInteraction::setFStatData).
///
/// A contact of two free particles has two lines, (P, I) and (I, P), with opposite n and t; one of a free and a fixed
/// particle has one. Each contact is counted once. Their point c is not used: in periodic boxes the files do not say in
/// whose image frame it lies.
///
/// A wall has a negative I, and for it n points from P into the wall: -(f_n n + f_t t) acts on P
/// (BaseInteraction::writeToFStat, BaseInteraction::setFStatData of a BaseWall). Such a contact has one line; its c
/// lies beside P. A file gives these contacts or those between particles, as is chosen.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "read/dump_file.hpp"
#include "read/line_reader.hpp"

namespace grainvdb {

class MercuryFstat final : public DumpFile {
 public:
  explicit MercuryFstat(LineReader lines) : lines_(std::move(lines)) {}

  static bool recognise(std::string_view head);
  static std::unique_ptr<DumpFile> open(std::unique_ptr<ByteStream> bytes, const std::string& file);

  /// Contacts between particles unless those with walls are chosen.
  void choose(RowKind wanted) override { with_walls_ = wanted == RowKind::wall_contacts; }
  /// Reads the whole frame, as nothing says how many contacts it has.
  std::optional<FrameHeader> next_header() override;
  bool skip_rows() override;
  /// The columns id1 id2 fx fy fz, with walls id fx fy fz cx cy cz, in ascending order of P and I. Has fewer rows than
  /// the header says: see above.
  DumpTable read_rows(const TableRequest& request) override;
  bool at_end() override { return lines_.at_end(); }
  void seek(const TextPosition& start) override;

 private:
  std::string_view comment_line();

  LineReader lines_;
  bool with_walls_ = false;
  FrameHeader header_;     ///< of the frame whose rows come next
  TextPosition rows_;      ///< where they begin
  TextPosition end_;       ///< where they end
  bool complete_ = true;   ///< whether the last of them ends in a newline
  std::size_t frame_ = 0;  ///< number of the next frame in the file
};

}  // namespace grainvdb
