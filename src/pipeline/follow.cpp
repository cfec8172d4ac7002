#include "grainvdb/follow.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "pipeline/checkpoint.hpp"
#include "pipeline/provenance.hpp"
#include "pipeline/run_into.hpp"
#include "pipeline/stream.hpp"

namespace grainvdb {
namespace {

using Clock = std::chrono::steady_clock;

void refuse_frames_from_the_end(const Pipeline& pipeline) {
  const FrameRange& frames = pipeline.frames;
  if (frames.start.value_or(0) >= 0 && frames.stop.value_or(0) >= 0) return;
  throw ConfigError({pipeline.location("frames"),
                     "frames are counted from the end, which is not known while the input is being written",
                     {},
                     "frames that are counted from the beginning",
                     {}});
}

/// Ends the waiting.
class Patience {
 public:
  explicit Patience(const FollowOptions& options) : options_(options) {}

  /// Whether frames have come.
  bool note(std::size_t frames) {
    if (frames <= frames_) return false;  // fewer where a file could not be read just now
    frames_ = frames;
    since_ = Clock::now();
    return true;
  }
  bool has_ended() const {
    return options_.timeout && Clock::now() - since_ >= std::chrono::duration<double>(*options_.timeout);
  }

 private:
  const FollowOptions& options_;
  std::size_t frames_ = 0;
  Clock::time_point since_ = Clock::now();
};

/// Waits, and says so often enough for the caller to interrupt it.
void wait_for(double seconds, const Progress& now, const std::function<void(const Progress&)>& progress) {
  constexpr std::chrono::duration<double> longest(0.1);
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    if (progress) progress(now);
    std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(longest, end - Clock::now()));
  }
}

std::unique_ptr<FrameSource> frames_up_to(std::int64_t step, FollowedInput& input) {
  if (auto source = input.look(step)) return source;
  throw InputError({{}, "the first frame comes after the last step that is wanted", {}, std::to_string(step), {}});
}

}  // namespace

RunReport follow_pipeline(const Pipeline& pipeline, const Plan& plan, FollowedInput& input,
                          const std::vector<std::unique_ptr<FieldSink>>& sinks,
                          const std::vector<std::unique_ptr<TracerSink>>& tracer_sinks, const FollowOptions& options,
                          const CheckpointOptions& checkpoint, const std::function<void(const Progress&)>& progress) {
  if (!options.last_step && !options.timeout) throw std::invalid_argument("nothing would end the waiting for frames");
  refuse_frames_from_the_end(pipeline);
  Checkpoint kept(checkpoint, key_of_run(pipeline));
  Patience patience(options);
  Progress now;
  now.doing = "waiting for frames";
  for (;;) {
    const std::unique_ptr<FrameSource> source = input.look();
    const std::size_t frames = source ? source->frames().size() : 0;
    const bool come = patience.note(frames);
    if (options.last_step && frames > 0 && source->frames().back().step >= *options.last_step)
      return run_into({sinks, tracer_sinks}, pipeline, plan, *frames_up_to(*options.last_step, input), progress, &kept);
    if (patience.has_ended())
      return run_into({sinks, tracer_sinks}, pipeline, plan, *open_dumps(input.spec()), progress, &kept);
    if (come && !plan.stages.empty() && !select_frames(pipeline.frames, frames).empty())
      now.frames_done = stream_certain(pipeline, plan, *source, progress, kept);
    now.frames_total = now.frames_done;
    wait_for(options.interval, now, progress);
  }
}

}  // namespace grainvdb
