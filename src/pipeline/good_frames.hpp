#pragma once
/// An input of which some frames are known to be bad: they are so whatever is read of them.
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/error.hpp"
#include "grainvdb/frame_source.hpp"

namespace grainvdb {

class GoodFrames : public FrameSource {
 public:
  /// The source must outlive it.
  GoodFrames(FrameSource& source, const std::vector<BadFrame>& bad) : source_(source) {
    for (const BadFrame& frame : bad)
      if (frame.step) bad_.insert(*frame.step);
  }

  /// Whether it is one of those that were known to be bad.
  bool leaves_out(const BadFrame& frame) const { return frame.step && bad_.contains(*frame.step); }

  const std::vector<FrameInfo>& frames() const override { return source_.frames(); }
  const UnitSystem& units() const override { return source_.units(); }
  const std::vector<std::string>& particle_columns() const override { return source_.particle_columns(); }
  std::vector<std::string> contact_columns() override { return source_.contact_columns(); }
  std::vector<std::string> wall_contact_columns() override { return source_.wall_contact_columns(); }
  std::vector<std::pair<std::string, std::uintmax_t>> files() const override { return source_.files(); }
  void require(std::size_t k, ColumnSet wanted) override { source_.require(k, wanted); }
  Frame read(std::size_t k, ColumnSet wanted) override {
    const FrameInfo& frame = frames()[k];
    if (bad_.contains(frame.step)) throw InputError({{frame.file, 0}, "a frame that is left out", {}, {}, {}});
    return source_.read(k, wanted);
  }
  std::vector<BadFrame> unreadable() const override { return source_.unreadable(); }
  const ReadCounters& counters() const override { return source_.counters(); }

 private:
  FrameSource& source_;
  std::set<std::int64_t> bad_;  // steps
};

}  // namespace grainvdb
