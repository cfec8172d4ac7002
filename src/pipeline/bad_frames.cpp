#include "pipeline/bad_frames.hpp"

#include <cstdint>
#include <set>

namespace grainvdb {

std::vector<std::size_t> without_bad(std::vector<std::size_t> frames, const FrameSource& source,
                                     const std::vector<BadFrame>& bad) {
  std::set<std::int64_t> steps;
  for (const BadFrame& frame : bad)
    if (frame.step) steps.insert(*frame.step);
  std::erase_if(frames, [&](std::size_t k) { return steps.contains(source.frames()[k].step); });
  return frames;
}

void BadFrames::add(std::size_t frame, const std::exception_ptr& fault) {
  try {
    std::rethrow_exception(fault);
  } catch (const InputError& error) {
    reasons_.emplace(frame, error.what());
  }
}

std::vector<BadFrame> BadFrames::list(const FrameSource& source) const {
  std::vector<BadFrame> all = source.unreadable();
  for (const auto& [frame, reason] : reasons_)
    all.push_back({source.frames()[frame].file, source.frames()[frame].step, reason});
  return all;
}

void BadFrames::save(ByteWriter& to) const {
  to.number(std::uint64_t{reasons_.size()});
  for (const auto& [frame, reason] : reasons_) {
    to.number(std::uint64_t{frame});
    to.text(reason);
  }
}

void BadFrames::load(ByteReader& from) {
  for (std::size_t left = from.count(); left > 0; --left) {
    const std::size_t frame = from.count();
    reasons_.emplace(frame, from.text());
  }
}

}  // namespace grainvdb
