#include "pipeline/bad_frames.hpp"

namespace grainvdb {

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

}  // namespace grainvdb
