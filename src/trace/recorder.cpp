#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/parallel.hpp"
#include "grainvdb/tracer_recorder.hpp"
#include "trace/stencil.hpp"

namespace grainvdb {
namespace {

/// Tracers that one task samples.
constexpr std::size_t chunk_length = 1024;

/// Components of a recorded field.
std::size_t width_of(const FieldMeta& field) {
  return static_cast<std::size_t>(field.components);
}

}  // namespace

TracerRecorder::TracerRecorder(const Tracers& tracers, const Lattice& lattice, const RecordedColumns& columns,
                               Interpolation interpolation)
    : lattice_(lattice), columns_(columns), interpolation_(interpolation), index_(std::make_unique<LeafIndex>()) {
  if (columns.step_numbers && !tracers.settings().step_numbers)
    throw std::invalid_argument("Co and K are to be recorded, but the tracers do not compute them");
  const std::size_t n = tracers.size();
  for (std::size_t a = 0; a < 3; ++a) {
    sample_.position[a].resize(n);
    sample_.image[a].resize(n);
    sample_.displacement[a].resize(n);
  }
  if (columns.strain) sample_.strain.resize(n);
  if (columns.step_numbers) {
    sample_.courant.resize(n);
    sample_.gradient_number.resize(n);
  }
  for (const FieldMeta& field : columns.fields)
    sample_.fields.emplace_back(n * width_of(field), std::numeric_limits<float>::quiet_NaN());
  sample_.stop.resize(n);
  sample_.stop_time.resize(n);
}
TracerRecorder::~TracerRecorder() = default;
TracerRecorder::TracerRecorder(TracerRecorder&&) noexcept = default;
TracerRecorder& TracerRecorder::operator=(TracerRecorder&&) noexcept = default;

void TracerRecorder::check(const Tracers& tracers, const std::vector<const SparseField*>& fields,
                           const Mask* mask) const {
  if (tracers.size() != sample_.stop.size())
    throw std::invalid_argument("the recorder was made for another number of tracers");
  if (fields.size() != columns_.fields.size())
    throw std::invalid_argument("the recorder was made for another number of fields");
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const FieldMeta& expected = columns_.fields[f];
    if (fields[f]->meta().name != expected.name || fields[f]->components() != expected.components)
      throw std::invalid_argument("the recorder expects " + expected.name + ", found " + fields[f]->meta().name);
    if (fields[f]->topology() != fields[0]->topology())
      throw std::invalid_argument("recorded fields must share one topology");
  }
  if (mask != nullptr && !fields.empty() && mask->topology() != fields[0]->topology())
    throw std::invalid_argument("recorded fields must share the topology of their mask");
}

void TracerRecorder::copy_state(const Tracers& tracers, std::size_t i) {
  const TracerState& s = tracers.state();
  const Box& box = tracers.box();
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = s.position[a][i];
    sample_.position[a][i] = x;
    sample_.image[a][i] = s.image[a][i];
    sample_.displacement[a][i] = x + s.image[a][i] * box.length(static_cast<int>(a)) - s.seed[a][i];
  }
  if (columns_.strain) sample_.strain[i] = s.strain[i];
  if (columns_.step_numbers) {
    sample_.courant[i] = s.courant[i];
    sample_.gradient_number[i] = s.gradient_number[i];
  }
}

void TracerRecorder::record_some(Tracers& tracers, const std::vector<const SparseField*>& fields, const Mask* mask,
                                 std::size_t begin, std::size_t end, Undefined& undefined) {
  const TracerState& s = tracers.state();
  const Topology nothing;
  Stencil stencil(lattice_, fields.empty() ? nothing : *topology_, *index_, interpolation_);
  std::vector<std::vector<float>> values;
  for (const FieldMeta& field : columns_.fields) values.emplace_back(width_of(field));
  for (std::size_t i = begin; i < end; ++i) {
    const bool moving = s.stop[i] == TracerStop::moving;
    if (moving || first_) {
      bool defined = true;
      std::uint32_t reasons = 0;
      // Seeds that have left the domain may lie anywhere.
      const bool can_sample = !fields.empty() && s.stop[i] != TracerStop::left_domain;
      if (can_sample) stencil.move_to({s.position[0][i], s.position[1][i], s.position[2][i]});
      for (std::size_t f = 0; f < fields.size() && can_sample; ++f) {
        if (stencil.sample(*fields[f], values[f].data())) continue;
        defined = false;
        reasons |= stencil.reasons(*fields[f], mask);
      }
      if (moving && !defined) {
        for (std::size_t bit = 0; bit < undefined.samples.size(); ++bit)
          undefined.samples[bit] += (reasons >> bit) & 1U;
        if (tracers.settings().on_undefined == OnUndefined::stop)
          tracers.stop(i, stencil.inside() ? TracerStop::masked : TracerStop::left_material);
      }
      if (first_ || s.stop[i] == TracerStop::moving) {
        copy_state(tracers, i);
        for (std::size_t f = 0; f < fields.size() && can_sample; ++f)
          std::copy(values[f].begin(), values[f].end(),
                    sample_.fields[f].begin() + static_cast<std::ptrdiff_t>(i * values[f].size()));
      }
    }
    sample_.stop[i] = s.stop[i];
    sample_.stop_time[i] = s.stop_time[i];
  }
}

const TracerSample& TracerRecorder::record(Tracers& tracers, const std::vector<const SparseField*>& fields,
                                           const Mask* mask, std::int64_t step) {
  check(tracers, fields, mask);
  if (!fields.empty() && fields[0]->topology() != topology_) {
    topology_ = fields[0]->topology();
    *index_ = LeafIndex(*topology_);
  }
  const std::size_t n = tracers.size();
  std::vector<Undefined> undefined((n + chunk_length - 1) / chunk_length);
  parallel_for(undefined.size(), [&](std::size_t c) {
    record_some(tracers, fields, mask, c * chunk_length, std::min(n, (c + 1) * chunk_length), undefined[c]);
  });
  for (const Undefined& u : undefined)
    for (std::size_t bit = 0; bit < u.samples.size(); ++bit) undefined_.samples[bit] += u.samples[bit];
  sample_.time = tracers.time();
  sample_.step = step;
  first_ = false;
  return sample_;
}

std::map<Reason, std::size_t> TracerRecorder::undefined() const {
  std::map<Reason, std::size_t> counts;
  for (std::size_t bit = 0; bit < undefined_.samples.size(); ++bit)
    if (undefined_.samples[bit] > 0) counts[static_cast<Reason>(1U << bit)] = undefined_.samples[bit];
  return counts;
}

}  // namespace grainvdb
