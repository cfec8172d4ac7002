#include "pipeline/shared_frames.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace grainvdb {

SharedFrames::SharedFrames(FrameSource& source, std::size_t users, std::size_t ahead)
    : source_(source), ahead_(ahead), users_(users), next_(users) {}

Frame SharedFrames::read(std::size_t user, std::size_t k, ColumnSet wanted) {
  std::unique_lock lock(turn_);
  const std::size_t n = next_[user]++;
  const auto end = [&] { return first_ + slots_.size(); };
  changed_.wait(lock, [&] { return abandoned_ || n < end() || (!reading_ && slots_.size() < ahead_); });
  if (abandoned_) throw Abandoned();
  if (n == end()) {
    // References to the other items of a deque stay good while it grows and shrinks at its ends.
    Slot& slot = slots_.emplace_back();
    slot.frame = k;
    slot.users_left = users_;
    reading_ = true;
    lock.unlock();
    Frame content;
    std::exception_ptr fault;
    try {
      const std::lock_guard source_lock(source_turn_);
      content = source_.read(k, wanted);
    } catch (...) {
      fault = std::current_exception();
    }
    lock.lock();
    most_particles_ = std::max(most_particles_, content.particles.size());
    most_contacts_ = std::max(most_contacts_, content.contacts.size() + content.wall_contacts.size());
    slot.content = std::move(content);
    slot.fault = fault;
    slot.ready = true;
    reading_ = false;
    changed_.notify_all();
  }
  changed_.wait(lock, [&] { return abandoned_ || slots_[n - first_].ready; });
  if (abandoned_) throw Abandoned();
  Slot& slot = slots_[n - first_];
  if (slot.frame != k) throw std::logic_error("users of shared frames want them in different orders");
  const std::exception_ptr fault = slot.fault;
  --slot.users_left;
  Frame frame = slot.users_left == 0 ? std::move(slot.content) : slot.content;
  drop_used();
  if (fault) std::rethrow_exception(fault);
  return frame;
}

/// Slots are used up in their order: every user takes them in that order.
void SharedFrames::drop_used() {
  while (!slots_.empty() && slots_.front().ready && slots_.front().users_left == 0) {
    slots_.pop_front();
    ++first_;
  }
  changed_.notify_all();
}

void SharedFrames::leave(std::size_t user) {
  const std::lock_guard lock(turn_);
  --users_;
  for (std::size_t n = std::max(next_[user], first_); n < first_ + slots_.size(); ++n) --slots_[n - first_].users_left;
  drop_used();
}

std::pair<double, double> SharedFrames::largest() {
  const std::lock_guard lock(turn_);
  return {static_cast<double>(most_particles_), static_cast<double>(most_contacts_)};
}

void SharedFrames::abandon() {
  const std::lock_guard lock(turn_);
  abandoned_ = true;
  changed_.notify_all();
}

}  // namespace grainvdb
