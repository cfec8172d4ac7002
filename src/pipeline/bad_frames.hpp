#pragma once
/// The frames that a run leaves out, and how it comes to know them.
#include <cstddef>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "grainvdb/error.hpp"
#include "grainvdb/frame_source.hpp"

namespace grainvdb {

/// What a step made of a frame, or what is wrong with the frame.
template <class T>
struct OrFault {
  std::optional<T> value;
  std::exception_ptr fault;
};

/// f(), or what it threw.
template <class F>
OrFault<std::invoke_result_t<F&>> attempt(F f) {
  try {
    return {f(), nullptr};
  } catch (...) {
    return {std::nullopt, std::current_exception()};
  }
}

/// Those of the frames, by index into the source, that are none of the bad ones.
std::vector<std::size_t> without_bad(std::vector<std::size_t> frames, const FrameSource& source,
                                     const std::vector<BadFrame>& bad);

class BadFrames {
 public:
  bool contains(std::size_t frame) const { return reasons_.contains(frame); }
  std::size_t count() const { return reasons_.size(); }
  /// Throws the fault where it is none of the frame, but no InputError.
  void add(std::size_t frame, const std::exception_ptr& fault);
  /// First what the index of the source leaves out.
  std::vector<BadFrame> list(const FrameSource& source) const;

  void save(ByteWriter& to) const;
  void load(ByteReader& from);

 private:
  std::map<std::size_t, std::string> reasons_;  // by index into the source
};

}  // namespace grainvdb
