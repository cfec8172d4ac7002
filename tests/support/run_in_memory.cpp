#include "support/run_in_memory.hpp"

#include <memory>
#include <stdexcept>

#include "support/memory_source.hpp"

namespace grainvdb::testing {

Pipeline make_pipeline(double voxel, const Vec3& origin, double cutoff, std::vector<std::string> fields) {
  Pipeline p;
  p.file = "test";
  p.voxel = voxel;
  p.origin = origin;
  p.cutoff = cutoff;
  p.fields = std::move(fields);
  p.stages = StageRegistry::standard().default_settings();
  return p;
}

void set_option(Pipeline& pipeline, const std::string& stage, const std::string& name, OptionValue value) {
  pipeline.stages.at(stage).at(name) = std::move(value);
}

std::vector<std::string> all_fields() {
  std::vector<std::string> names;
  for (const Stage& s : StageRegistry::standard().stages())
    if (s.error_of.empty()) names.push_back(s.name);
  return names;
}

std::vector<std::string> all_errors() {
  std::vector<std::string> names;
  for (const Stage& s : StageRegistry::standard().stages())
    if (!s.error_of.empty()) names.push_back(s.name);
  return names;
}

const Written& Result::only() const {
  if (record.times.size() != 1) throw std::logic_error("not one output time");
  return record.times.front();
}

Result run(const Pipeline& pipeline, FrameSource& source) {
  const auto record = std::make_shared<Record>();
  std::vector<std::unique_ptr<FieldSink>> sinks;
  sinks.push_back(std::make_unique<MemorySink>(record));
  Result result;
  result.plan = make_plan(pipeline);
  result.report = run_pipeline(pipeline, result.plan, source, sinks);
  result.record = std::move(*record);
  return result;
}

Result run(Pipeline pipeline, const std::vector<Frame>& frames) {
  pipeline.input.contacts.files = {"memory"};
  for (const Frame& frame : frames)
    if (frame.wall_contacts.size() > 0) pipeline.input.wall_contacts.files = {"memory"};
  MemorySource source(frames);
  return run(pipeline, source);
}

RunReport measure(const Pipeline& pipeline, FrameSource& source) {
  return run_pipeline(pipeline, make_plan(pipeline), source, std::vector<std::unique_ptr<FieldSink>>{});
}

}  // namespace grainvdb::testing
