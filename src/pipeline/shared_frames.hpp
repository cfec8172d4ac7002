#pragma once
/// Frames that are read once for several users, who all want the same frames in the same order.
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <utility>
#include <vector>

#include "grainvdb/frame_source.hpp"

namespace grainvdb {

class SharedFrames {
 public:
  /// No user gets more than `ahead` frames ahead of another. The source must outlive the object.
  SharedFrames(FrameSource& source, std::size_t users, std::size_t ahead);

  /// The next frame of a user. Several users may call at the same time; the same user may not.
  Frame read(std::size_t user, std::size_t k, ColumnSet wanted);
  /// A user wants nothing more: the others wait no longer for it.
  void leave(std::size_t user);
  /// Ends all waiting: further calls of read throw Abandoned.
  void abandon();
  struct Abandoned {};
  /// Particles and contacts of the largest frame so far, as it was read.
  std::pair<double, double> largest();

  /// Calls f(source) while nobody else uses it.
  template <class F>
  auto with_source(F f) {
    const std::lock_guard lock(source_turn_);
    return f(source_);
  }
  const FrameSource& source() const { return source_; }

 private:
  struct Slot {
    std::size_t frame = 0;
    Frame content{};
    std::exception_ptr fault{};
    bool ready = false;
    std::size_t users_left = 0;
  };
  void drop_used();

  FrameSource& source_;
  std::size_t ahead_;
  std::mutex source_turn_;
  std::mutex turn_;  // of all below
  std::condition_variable changed_;
  std::deque<Slot> slots_;
  std::size_t first_ = 0;  // number of the first slot
  bool reading_ = false;
  bool abandoned_ = false;
  std::size_t users_;
  std::vector<std::size_t> next_;  // slot of each user
  std::size_t most_particles_ = 0, most_contacts_ = 0;
};

}  // namespace grainvdb
