#include "pipeline/no_material.hpp"

#include <set>
#include <string>
#include <vector>

#include "base/listed.hpp"
#include "pipeline/unless_bad.hpp"

namespace grainvdb {
namespace {

template <class Types>
std::string types_text(const Types& types) {
  return (types.size() == 1 ? "type " : "types ") + listed(types, [](int type) { return std::to_string(type); });
}

/// Empty where no frame has particles.
std::string types_there(const InputSpec& input, FrameSource& source, std::span<const std::size_t> frames) {
  for (const std::size_t k : frames) {
    const auto frame = read_unless_bad(input, source, k, Column::type);
    if (!frame || frame->particles.size() == 0) continue;
    const std::vector<int>& all = frame->particles.type;
    return types_text(std::set<int>(all.begin(), all.end())) + " at step " + std::to_string(frame->step);
  }
  return {};
}

}  // namespace

void refuse_no_material(const Pipeline& pipeline, FrameSource& source, std::span<const std::size_t> frames) {
  const std::vector<int>& wanted = pipeline.select.types;
  throw InputError({{source.frames()[frames.front()].file, 0},
                    "no material in any of the frames",
                    wanted.empty() ? std::string() : types_there(pipeline.input, source, frames),
                    "at least one particle that select keeps" +
                        (wanted.empty() ? std::string() : ", which wants " + types_text(wanted)),
                    "Check select and frames"});
}

}  // namespace grainvdb
