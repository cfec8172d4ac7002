#include "fields/moments.hpp"
#include "fields/register.hpp"

namespace grainvdb {

void register_bookkeeping(StageRegistry& registry) {
  Stage frames;
  frames.name = "frames";
  frames.additive = true;
  frames.description = "samples per voxel: the frames in which a kernel reached it";
  frames.equation = "number of frames with W > 0";
  frames.needs = [](const StageSettings&) { return StageNeeds{{}, {volume_moment()}}; };
  frames.compute = [](const StageInput& in, SparseField& out) {
    for_each_leaf(in.topology(), [&](std::size_t leaf) {
      const double* count = in.frame_count(leaf);
      float* to = out.leaf(leaf);
      in.topology().mask(leaf).for_each([&](int v) { to[v] = static_cast<float>(count[v]); });
    });
  };
  registry.add(std::move(frames));

  Stage mask;
  mask.name = "mask";
  mask.additive = true;
  mask.description = "why other fields are undefined: bit flags, their meaning in the attributes";
  mask.equation = "sum of the bits of all reasons that apply";
  mask.needs = [](const StageSettings&) { return StageNeeds{}; };
  registry.add(std::move(mask));
}

}  // namespace grainvdb
