#include "pipeline/window.hpp"

#include <utility>

namespace grainvdb {

WindowAverager::WindowAverager(const Pipeline& pipeline, const Plan& plan, const Lattice& lattice)
    : plan_(plan), setting_(pipeline, lattice), bytes_per_leaf_(MomentSums(plan.means).bytes(1)) {
  for (const Sweep& sweep : plan.sweeps) groups_.push_back(group_moments(sweep));
  begin_window();
}

void WindowAverager::begin_window() {
  means_.reset();
  sums_.emplace(plan_.means);
}

std::unique_ptr<FrameContext> WindowAverager::prepare(std::shared_ptr<const Material> material,
                                                      std::size_t sweep) const {
  auto context = std::make_unique<FrameContext>(std::move(material), setting_, groups_[sweep]);
  context->prepare(bytes_per_leaf_);
  return context;
}

void WindowAverager::add(FrameContext& frame) {
  frame.run(*sums_, means_ ? &*means_ : nullptr);
  sums_->end_frame();
}

void WindowAverager::end_sweep(std::size_t frames) {
  sums_->end_sweep(frames);
  means_.emplace(sums_->means());
}

}  // namespace grainvdb
