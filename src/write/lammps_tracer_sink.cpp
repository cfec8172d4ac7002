#include "write/lammps_tracer_sink.hpp"

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "grainvdb/units.hpp"
#include "write/atomic_file.hpp"
#include "write/number_text.hpp"
#include "write/tracer_columns.hpp"

namespace grainvdb {
namespace {

/// Text is handed to the file in pieces of about this size.
constexpr std::size_t piece = 1 << 20;

std::vector<std::string> column_names(const std::string& name, std::size_t components) {
  if (components == 1) return {name};
  if (name == "velocity") return {"vx", "vy", "vz"};
  if (name == "angular_velocity") return {"omegax", "omegay", "omegaz"};
  std::vector<std::string> names;
  for (std::size_t k = 0; k < components; ++k)
    names.push_back(name + '_' + (components == 9 ? std::string{"xyz"[k / 3], "xyz"[k % 3]} : std::to_string(k + 1)));
  return names;
}

class LammpsTracerSink final : public TracerSink {
 public:
  explicit LammpsTracerSink(const std::string& directory)
      : path_((std::filesystem::path(directory) / "tracers.dump").string()) {}

  void begin(const TracerLayout& layout) override;
  void write(const TracerSample& sample) override;
  void commit(const Provenance& provenance) override;
  std::vector<std::string> files() const override { return {path_}; }

 private:
  template <class T>
  void add(T value);
  void add_header(const TracerSample& sample);
  void add_columns(const TracerSample& sample);
  void add_row(const TracerSample& sample, const std::vector<TracerNumbers>& numbers, std::size_t tracer);
  void flush();

  std::string path_;
  std::optional<TracerLayout> layout_;
  std::optional<TracerSampleCheck> check_;
  std::unique_ptr<AtomicFile> file_;
  std::string text_;
  std::uint64_t written_ = 0;
};

void LammpsTracerSink::begin(const TracerLayout& layout) {
  if (layout_) throw std::logic_error("an output can begin only once");
  check_.emplace(layout);
  layout_ = layout;
  file_ = std::make_unique<AtomicFile>(path_);
}

/// A number and a blank.
template <class T>
void LammpsTracerSink::add(T value) {
  append_number(text_, value);
  text_ += ' ';
}

void LammpsTracerSink::add_header(const TracerSample& sample) {
  if (check_->samples() == 1 && find_unit_system(layout_->unit_system) != nullptr)
    text_ += "ITEM: UNITS\n" + layout_->unit_system + '\n';
  if (layout_->time_unit != "step") {
    text_ += "ITEM: TIME\n";
    add(sample.time);
    text_.back() = '\n';
  }
  const Box& box = layout_->box;
  text_ += "ITEM: TIMESTEP\n" + std::to_string(sample.step) + "\nITEM: NUMBER OF ATOMS\n" +
           std::to_string(layout_->id.size()) + "\nITEM: BOX BOUNDS";
  for (const bool periodic : box.periodic) text_ += periodic ? " pp" : " ff";
  text_ += '\n';
  for (std::size_t a = 0; a < 3; ++a) {
    add(box.lo[a]);
    add(box.hi[a]);
    text_.back() = '\n';
  }
}

void LammpsTracerSink::add_columns(const TracerSample& sample) {
  text_ += "ITEM: ATOMS id type x y z ix iy iz ";
  const auto name = [&](const std::string& quantity, std::size_t components) {
    for (const std::string& column : column_names(quantity, components)) text_ += column + ' ';
  };
  for (const FieldMeta& f : layout_->fields) name(f.name, static_cast<std::size_t>(f.components));
  for (const TracerNumbers& n : numbers_of(sample, *layout_)) name(n.name, n.values.size());
  text_ += "stop\n";
}

void LammpsTracerSink::add_row(const TracerSample& sample, const std::vector<TracerNumbers>& numbers,
                               std::size_t tracer) {
  add(layout_->id[tracer]);
  text_ += "1 ";
  for (const auto& axis : sample.position) add(axis[tracer]);
  for (const auto& axis : sample.image) add(axis[tracer]);
  for (std::size_t f = 0; f < sample.fields.size(); ++f) {
    const auto n = static_cast<std::size_t>(layout_->fields[f].components);
    for (std::size_t k = 0; k < n; ++k) add(sample.fields[f][tracer * n + k]);
  }
  for (const TracerNumbers& n : numbers)
    for (const std::vector<double>* component : n.values) add((*component)[tracer]);
  add(static_cast<int>(sample.stop[tracer]));
  text_.back() = '\n';
}

void LammpsTracerSink::flush() {
  file_->write(written_, text_);
  written_ += text_.size();
  text_.clear();
}

void LammpsTracerSink::write(const TracerSample& sample) {
  if (!file_) throw std::logic_error("a sample before the output began");
  check_->check(sample);
  add_header(sample);
  add_columns(sample);
  const std::vector<TracerNumbers> numbers = numbers_of(sample, *layout_);
  for (std::size_t tracer = 0; tracer < layout_->id.size(); ++tracer) {
    add_row(sample, numbers, tracer);
    if (text_.size() >= piece) flush();
  }
  flush();
}

void LammpsTracerSink::commit(const Provenance&) {
  if (!file_ || check_->samples() == 0) throw std::logic_error("an output of tracers was committed without a sample");
  file_->finish();
  file_->publish();
}

}  // namespace

std::unique_ptr<TracerSink> make_lammps_tracer_sink(const std::string& directory) {
  return std::make_unique<LammpsTracerSink>(directory);
}

}  // namespace grainvdb
