#include "pipeline/steps.hpp"

#include <string>

#include "grainvdb/error.hpp"

namespace grainvdb {

std::vector<std::int64_t> steps_of(const FrameSource& source, std::span<const std::size_t> frames) {
  std::vector<std::int64_t> steps;
  for (const std::size_t k : frames) steps.push_back(source.frames()[k].step);
  return steps;
}

void require_first_steps(const FrameSource& source, std::span<const std::size_t> frames,
                         const std::vector<std::int64_t>& steps) {
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const FrameInfo* const found = n < frames.size() ? &source.frames()[frames[n]] : nullptr;
    if (found != nullptr && found->step == steps[n]) continue;
    throw InputError({{found != nullptr ? found->file : std::string(), 0},
                      "the frames are not those that were summed before",
                      found != nullptr ? "step " + std::to_string(found->step) : "no further frame",
                      "step " + std::to_string(steps[n]),
                      "Remove the checkpoint in the output folder to begin anew"});
  }
}

}  // namespace grainvdb
