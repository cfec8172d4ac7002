#pragma once
/// Dumps that a simulation is still writing.
#include <cstdint>
#include <memory>
#include <optional>

#include "grainvdb/frame_source.hpp"

namespace grainvdb {

/// Looks at an input again and again. A frame is there once it is complete and settled: its header and all its rows
/// stand in the file, the last of which ends its line, and the file has not changed since the look before, or goes on
/// with another frame. Frames are there in the order of their files: those behind a file that grows wait for it; what
/// is malformed in a file that has settled before one with frames will not be completed, and is bad. Where contacts are
/// read, frames are there up to the first that lacks its contacts.
class FollowedInput {
 public:
  /// Throws ConfigError as open_dumps does.
  explicit FollowedInput(InputSpec spec);
  ~FollowedInput();
  FollowedInput(const FollowedInput&) = delete;
  FollowedInput& operator=(const FollowedInput&) = delete;

  const InputSpec& spec() const;

  /// The frames that are there by now, up to a step if one is given; nullptr when there are none. What is malformed or
  /// cannot be read counts as not there yet. Throws InputError for what is bad, unless bad frames are to be skipped.
  std::unique_ptr<FrameSource> look(std::optional<std::int64_t> last_step = {});

 private:
  struct Seen;
  std::unique_ptr<Seen> seen_;
};

}  // namespace grainvdb
