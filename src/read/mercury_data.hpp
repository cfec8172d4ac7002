#pragma once
/// MercuryDPM particle files (name.data): frames one after another, each a line with the number of particles, the time
/// and the bounds of the box, then a line per particle.
///
/// Three dimensions: N t xmin ymin zmin xmax ymax zmax, then rows x y z vx vy vz radius, three Euler angles,
/// omegax omegay omegaz, species. Two dimensions: N t xmin ymin xmax ymax, then rows x y vx vy radius angle -omegaz
/// species; such particles lie at z = 0.
///
/// A particle has no id but its place: that of row i, counted from 0, is i + 1, as name.fstat calls it i. MercuryDPM
/// gives the place of a deleted particle to the last one. The timestep is the number of the frame.
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

class MercuryData final : public DumpFile {
 public:
  explicit MercuryData(LineReader lines) : lines_(std::move(lines)) {}

  static bool recognise(std::string_view head);
  static std::unique_ptr<DumpFile> open(std::unique_ptr<ByteStream> bytes, const std::string& file);

  std::optional<FrameHeader> next_header() override;
  bool skip_rows() override;
  DumpTable read_rows(const TableRequest& request) override;
  bool at_end() override { return lines_.at_end(); }
  void seek(const TextPosition& start) override;

 private:
  LineReader lines_;
  FrameHeader rows_;       ///< of the frame whose rows come next, with the columns that they have
  std::size_t frame_ = 0;  ///< number of the next frame in the file
};

}  // namespace grainvdb
