#pragma once
/// Numbered items on their way through three steps that overlap: items differ in the step they are in, never in their
/// order.
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <tbb/parallel_pipeline.h>

namespace grainvdb {

/// For every item i in [0, n): `begin(i)`, then `prepare(i, what begin returned)`, then `finish(i, what prepare
/// returned)`. `begin` and `finish` are each called in the order of the items, one call at a time; `prepare` for
/// several items at the same time. No more than `in_flight` items are between begin and finish.
///
/// Throws what the first item throws that fails, after all before it are finished, however the threads come and go.
/// Items behind it may have been begun and prepared; they are not finished.
template <class Begin, class Prepare, class Finish>
void ordered_pipeline(std::size_t n, std::size_t in_flight, Begin begin, Prepare prepare, Finish finish) {
  using Begun = std::invoke_result_t<Begin&, std::size_t>;
  using Prepared = std::invoke_result_t<Prepare&, std::size_t, Begun>;
  struct Slot {
    std::size_t item = 0;
    std::optional<Begun> begun;
    std::optional<Prepared> prepared;
    std::exception_ptr error;
    std::mutex turn;
  };
  // Items leave in their order, so that the slot of item i - in_flight is free when item i begins.
  std::vector<Slot> slots(in_flight);
  // TBB lets only one in anyway: no lock ever waits, but the thread sanitizer does not see TBB's own hand-over.
  std::mutex begin_turn, finish_turn;
  using Lock = std::scoped_lock<std::mutex, std::mutex>;

  std::size_t next = 0;
  bool failed = false;
  const auto first = [&](tbb::flow_control& control) -> Slot* {
    if (next == n || failed) {
      control.stop();
      return nullptr;
    }
    Slot& slot = slots[next % in_flight];
    const Lock lock(begin_turn, slot.turn);
    slot.item = next++;
    try {
      slot.begun.emplace(begin(slot.item));
    } catch (...) {
      slot.error = std::current_exception();
      failed = true;
    }
    return &slot;
  };
  const auto second = [&](Slot* slot) {
    const std::lock_guard lock(slot->turn);
    if (slot->error) return slot;
    try {
      slot->prepared.emplace(prepare(slot->item, std::move(*slot->begun)));
    } catch (...) {
      slot->error = std::current_exception();
    }
    slot->begun.reset();
    return slot;
  };
  const auto third = [&](Slot* slot) {
    const Lock lock(finish_turn, slot->turn);
    if (slot->error) std::rethrow_exception(slot->error);
    finish(slot->item, std::move(*slot->prepared));
    slot->prepared.reset();
  };
  tbb::parallel_pipeline(in_flight, tbb::make_filter<void, Slot*>(tbb::filter_mode::serial_in_order, first) &
                                        tbb::make_filter<Slot*, Slot*>(tbb::filter_mode::parallel, second) &
                                        tbb::make_filter<Slot*, void>(tbb::filter_mode::serial_in_order, third));
}

}  // namespace grainvdb
