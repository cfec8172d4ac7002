#pragma once
/// What the files of MercuryDPM have in common.
///
/// Their format as the source of MercuryDPM has it (www.mercurydpm.org): DPMBase::outputXBallsData and
/// DPMBase::readNextDataFile for name.data, DPMBase::writeFstatHeader, BaseInteraction::writeToFStat and
/// DPMBase::readNextFStatFile for name.fstat.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "grainvdb/box.hpp"
#include "read/line_reader.hpp"

namespace grainvdb::mercury {

/// The numbers of a line; nothing where it has anything else. "nan" counts as a number, as MercuryDPM writes it for
/// what it does not know.
std::optional<std::vector<double>> numbers(std::string_view line);

/// MercuryDPM numbers no frames. The first of a file gets the number that ends the name of the file (name.data.12), or
/// 0.
std::int64_t first_step(const std::string& file);

/// Sets the bounds along one axis. Throws InputError, for the last line read, where there is nothing between them.
void set_bounds(Box& box, std::size_t axis, double lo, double hi, const LineReader& lines);

}  // namespace grainvdb::mercury
