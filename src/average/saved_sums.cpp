/// Sums on their way into a file and back.
#include <cstdint>
#include <string>

#include "average/moment_sums.hpp"
#include "average/window_sums.hpp"
#include "base/bytes.hpp"

namespace grainvdb {
namespace {

void save_names(ByteWriter& to, const std::set<std::string>& names) {
  to.number(std::uint64_t{names.size()});
  for (const std::string& name : names) to.text(name);
}

std::set<std::string> load_names(ByteReader& from) {
  std::set<std::string> names;
  for (std::size_t left = from.count(); left > 0; --left) names.insert(from.text());
  return names;
}

}  // namespace

void MomentSums::save(ByteWriter& to) const {
  to.number(first_sweep_);
  to.number(std::uint64_t{frames_});
  save_names(to, added_);
  save_names(to, complete_);
  to.number(std::uint64_t{leaves_.size()});
  for (const auto& [origin, leaf] : leaves_) {
    to.number(origin);
    to.number(leaf->mask);
    to.number(leaf->frames);
    to.numbers(leaf->reached_by);
    to.numbers(leaf->sums);
  }
}

void MomentSums::load(ByteReader& from) {
  first_sweep_ = from.number<bool>();
  frames_ = from.count();
  added_ = load_names(from);
  complete_ = load_names(from);
  for (std::size_t left = from.count(); left > 0; --left) {
    Leaf& to = leaf(from.number<Coord>());
    to.mask = from.number<LeafMask>();
    to.frames = from.number<std::array<double, leaf_size>>();
    to.reached_by = from.numbers<LeafMask>();
    to.sums = from.numbers<double>();
  }
}

void WindowSums::save(ByteWriter& to) const {
  all_.save(to);
  to.number(std::uint64_t{current_});
  to.number(std::uint64_t{blocks_.size()});
  for (const MomentSums& block : blocks_) block.save(to);
}

void WindowSums::load(ByteReader& from) {
  all_.load(from);
  current_ = from.count();
  for (std::size_t left = from.count(); left > 0; --left) blocks_.emplace_back(blocked_).load(from);
}

}  // namespace grainvdb
