#include "support/memory_tracers.hpp"

#include <cstring>
#include <stdexcept>
#include <utility>

#include "support/memory_source.hpp"

namespace grainvdb::testing {
namespace {

class MemoryTracerSink : public TracerSink {
 public:
  explicit MemoryTracerSink(Histories& histories) : histories_(histories) {}
  void begin(const TracerLayout& layout) override { histories_.layout = layout; }
  void write(const TracerSample& sample) override { histories_.samples.push_back(sample); }
  void commit(const Provenance& provenance) override { histories_.provenance = provenance; }
  std::vector<std::string> files() const override { return {}; }

 private:
  Histories& histories_;
};

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

template <class T, std::size_t n>
bool same(const std::array<std::vector<T>, n>& a, const std::array<std::vector<T>, n>& b) {
  for (std::size_t i = 0; i < n; ++i)
    if (!same(a[i], b[i])) return false;
  return true;
}

bool same(const TracerSample& a, const TracerSample& b) {
  bool equal = a.time == b.time && a.step == b.step && same(a.position, b.position) && same(a.image, b.image) &&
               same(a.displacement, b.displacement) && same(a.strain, b.strain) && same(a.courant, b.courant) &&
               same(a.gradient_number, b.gradient_number) && same(a.stop, b.stop) && same(a.stop_time, b.stop_time) &&
               a.fields.size() == b.fields.size();
  for (std::size_t f = 0; equal && f < a.fields.size(); ++f) equal = same(a.fields[f], b.fields[f]);
  return equal;
}

}  // namespace

Vec3 Histories::displacement(std::size_t tracer) const {
  const Columns3& d = samples.back().displacement;
  return {d[0].at(tracer), d[1].at(tracer), d[2].at(tracer)};
}

std::string Histories::provenance_text(const std::string& key) const {
  for (const auto& [name, text] : provenance)
    if (name == key) return text;
  throw std::out_of_range("no provenance " + key);
}

Histories trace(const Pipeline& pipeline, FrameSource& source) {
  Histories result;
  const auto record = std::make_shared<Record>();
  std::vector<std::unique_ptr<FieldSink>> sinks;
  if (!pipeline.fields.empty()) sinks.push_back(std::make_unique<MemorySink>(record));
  std::vector<std::unique_ptr<TracerSink>> tracer_sinks;
  tracer_sinks.push_back(std::make_unique<MemoryTracerSink>(result));
  result.report = run_pipeline(pipeline, make_plan(pipeline), source, sinks, tracer_sinks);
  result.fields = std::move(*record);
  return result;
}

Histories trace(Pipeline pipeline, const std::vector<Frame>& frames) {
  pipeline.input.contacts.files = {"memory"};
  MemorySource source(frames);
  return trace(pipeline, source);
}

bool same_histories(const Histories& a, const Histories& b) {
  if (a.samples.size() != b.samples.size() || !same(a.layout.id, b.layout.id)) return false;
  for (std::size_t t = 0; t < a.samples.size(); ++t)
    if (!same(a.samples[t], b.samples[t])) return false;
  return true;
}

}  // namespace grainvdb::testing
