#include "measure/field_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/partial_field.hpp"

namespace grainvdb {
namespace {

// The channels before those of the fields.
constexpr std::size_t weight_channel = 0, position_channel = 1, height_channel = 2, voxel_channel = 3,
                      field_channels = 4;
constexpr std::size_t most_components = 9;

/// principal_stress has three components, but is no vector.
bool turns(const std::string& field) {
  return field != "principal_stress";
}

}  // namespace

std::string volume_weight(const std::string& field) {
  static const std::array<std::string, 5> means{"velocity", "angular_velocity", "mean_diameter", "temperature",
                                                "rotational_fluctuation"};
  const PartialField part = partial_field(field);
  const bool by_volume = part.all != nullptr && std::find(means.begin(), means.end(), part.all->name) != means.end();
  return by_volume ? "phi" + part.suffix() : "";
}

const std::vector<std::string>& flow_fields() {
  static const std::vector<std::string> names{"phi",         "density",           "velocity", "mean_diameter",
                                              "temperature", "velocity_gradient", "stress",   "pressure_floor"};
  return names;
}

FieldProfile::FieldProfile(const BinSpec& spec, const Lattice& lattice, std::vector<std::string> fields)
    : bins_(spec, lattice) {
  for (std::string& name : fields) {
    std::string weight = volume_weight(name);
    parts_.push_back({std::move(name), std::move(weight)});
  }
}

const FieldProfile::Part* FieldProfile::part(const std::string& field) const {
  const auto it = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.name == field; });
  return it == parts_.end() ? nullptr : &*it;
}

int FieldProfile::components(const std::string& field) const {
  const Part* found = part(field);
  return found ? found->components : 1;
}

void FieldProfile::set_channels(const OutputFields& output) {
  std::size_t channels = field_channels;
  for (Part& p : parts_) {
    p.components = output.fields.at(p.name).components();
    p.first = channels;
    channels += 1 + static_cast<std::size_t>(p.components);
  }
  sums_.emplace(channels);
}

void FieldProfile::take(const OutputFields& output) {
  if (output.time.frame_count == 0) return;
  if (!sums_) set_channels(output);
  sums_->begin_time();
  std::vector<const SparseField*> fields, weights;
  for (const Part& p : parts_) {
    fields.push_back(&output.fields.at(p.name));
    weights.push_back(p.weight.empty() ? nullptr : &output.fields.at(p.weight));
  }
  if (fields.empty()) return;
  const double frames = static_cast<double>(output.time.frame_count);

  bins_.for_each(*fields.front()->topology(), [&](const VoxelPlace& place) {
    const std::span<double> sums = sums_->at(place.bin);
    sums[weight_channel] += frames;
    sums[position_channel] += frames * place.position;
    sums[height_channel] += frames * place.height;
    sums[voxel_channel] += 1;
    for (std::size_t n = 0; n < parts_.size(); ++n) {
      const Part& p = parts_[n];
      const double weight =
          weights[n] ? frames * static_cast<double>(weights[n]->leaf(place.leaf)[place.offset]) : frames;
      std::array<double, most_components> values{};
      bool known = weight > 0;
      for (int c = 0; c < p.components; ++c) {
        values[static_cast<std::size_t>(c)] = static_cast<double>(fields[n]->leaf(place.leaf, c)[place.offset]);
        known = known && std::isfinite(values[static_cast<std::size_t>(c)]);
      }
      if (!known) continue;
      if (turns(p.name)) bins_.rotate(place, {values.data(), static_cast<std::size_t>(p.components)});
      sums[p.first] += weight;
      for (int c = 0; c < p.components; ++c)
        sums[p.first + 1 + static_cast<std::size_t>(c)] += weight * values[static_cast<std::size_t>(c)];
    }
  });
}

FieldProfile::Means::Means(const FieldProfile& profile, std::int64_t bin, std::optional<std::size_t> without)
    : profile_(profile),
      sums_(profile.sums_->total(bin, without)),
      times_(static_cast<double>(profile.times() - (without ? 1 : 0))) {}

double FieldProfile::Means::position() const {
  return sums_[position_channel] / sums_[weight_channel];
}

double FieldProfile::Means::height() const {
  return sums_[height_channel] / sums_[weight_channel];
}

double FieldProfile::Means::voxels() const {
  return sums_[voxel_channel] / times_;
}

// 0/0 where no voxel has the field: NaN, as it should be.
double FieldProfile::Means::value(const std::string& field, int component) const {
  const Part* p = profile_.part(field);
  return p ? sums_[p->first + 1 + static_cast<std::size_t>(component)] / sums_[p->first] : FlowState::unknown;
}

FlowState FieldProfile::Means::state() const {
  return flow_state([&](const char* field, int component = 0) { return value(field, component); });
}

std::vector<Estimate> FieldProfile::estimate(std::int64_t bin, std::size_t outputs,
                                             const std::function<void(const Means&, std::span<double>)>& f) const {
  return jackknife(times(), outputs, [&](std::optional<std::size_t> without, std::span<double> out) {
    f(Means(*this, bin, without), out);
  });
}

}  // namespace grainvdb
