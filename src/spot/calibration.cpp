#include "spot/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/listed.hpp"
#include "measure/table_numbers.hpp"
#include "pipeline/number.hpp"
#include "pipeline/text.hpp"

namespace grainvdb::spot {
namespace {

constexpr const char* calibration_name = "spot_calibration";

const OptionValues& options_of(const Pipeline& pipeline) {
  return pipeline.measure.at(calibration_name);
}

double number(const Pipeline& pipeline, const char* name) {
  return std::get<double>(options_of(pipeline).at(name));
}

void check_parameters(const Pipeline& pipeline, const Table& calibration) {
  std::string missing;
  for (const char* name : {"radius", "step_side", "influence", "hop_rate", "insertion_rate"})
    if (const double x = number_of(calibration, name).value; !std::isfinite(x) || !(x > 0))
      missing += (missing.empty() ? "" : ", ") + std::string(name) + " (" + short_number(x) + ')';
  if (missing.empty()) return;
  std::string hint;
  for (const std::string& remark : calibration.remarks) hint += (hint.empty() ? "" : " ") + remark;
  if (hint.empty())
    hint = "Compare lo, hi, flow_from and phi_at_rest of measure.spot_calibration with where and when the silo flows.";
  throw InputError({pipeline.location("measure.spot_calibration"),
                    "the frames do not tell every parameter of the spot model", missing, "numbers above 0", hint});
}

/// Of the packing: the grains of a frame that a spot file would take.
struct Extent {
  Vec3 lo{}, hi{};  ///< of the grains, not of their centres
  std::size_t grains = 0;
};

Extent extent_of(const Frame& frame, const std::vector<int>& types, double bottom) {
  Extent extent;
  const Particles& p = frame.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!types.empty() && std::find(types.begin(), types.end(), p.type[i]) == types.end()) continue;
    if (p.position[2][i] < bottom) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      const double lo = p.position[a][i] - p.radius[i], hi = p.position[a][i] + p.radius[i];
      extent.lo[a] = extent.grains == 0 ? lo : std::min(extent.lo[a], lo);
      extent.hi[a] = extent.grains == 0 ? hi : std::max(extent.hi[a], hi);
    }
    ++extent.grains;
  }
  return extent;
}

/// The ends of the container: walls where they are given, the period, or as far as there are grains, outwards to a
/// thousandth.
Box container_of(const Pipeline& pipeline, const Frame& frame, const Extent& grains) {
  Box box = frame.box;
  const auto walls = std::get<std::vector<double>>(options_of(pipeline).at("side_walls"));
  for (std::size_t a = 0; a < 2; ++a) {
    if (box.periodic[a]) continue;
    box.lo[a] = std::floor(1e3 * grains.lo[a]) / 1e3;
    box.hi[a] = std::ceil(1e3 * grains.hi[a]) / 1e3;
  }
  if (!walls.empty()) {
    box.lo[0] = walls[0];
    box.hi[0] = walls[1];
    box.periodic[0] = false;
  }
  box.lo[2] = number(pipeline, "bottom");
  box.hi[2] = std::ceil(1e3 * grains.hi[2]) / 1e3;
  box.periodic[2] = false;
  return box;
}

std::string list(const Vec3& x) {
  return '[' + listed(x, &print_number) + ']';
}

std::string packing_text(const Pipeline& pipeline, std::size_t frame) {
  std::vector<std::string> files, types;
  for (const std::string& file : pipeline.input.particles)
    files.push_back(yaml_text(std::filesystem::absolute(file).lexically_normal().string()));
  for (const int type : pipeline.select.types) types.push_back(std::to_string(type));
  std::string text = "packing:\n  dump: [" + listed(files) + "]\n  frame: " + std::to_string(frame) + '\n';
  if (!types.empty()) text += "  types: [" + listed(types) + "]\n";
  if (pipeline.input.radius) text += "  radius: " + print_number(*pipeline.input.radius) + '\n';
  return text;
}

std::string container_text(const Pipeline& pipeline, const Box& box) {
  std::vector<std::string> periodic;
  for (std::size_t a = 0; a < 3; ++a)
    if (box.periodic[a]) periodic.emplace_back(1, "xyz"[a]);
  std::string text = "\ncontainer:\n  lo: " + list(box.lo) + "\n  hi: " + list(box.hi) + '\n';
  if (!periodic.empty()) text += "  periodic: [" + listed(periodic) + "]\n";
  return text + "  orifice:\n    shape: slot\n    width: " + print_number(number(pipeline, "slot_width")) +
         "\n    centre: [" + print_number(number(pipeline, "slot")) + ", 0]\n";
}

/// "  name: 12.3   # +- 0.4, description"
std::string line(const std::string& key, const Quantity& q) {
  std::string text = "  " + key + ": " + print_number(std::stod(short_number(q.value))) + "  # ";
  if (std::isfinite(q.error)) text += "+- " + short_number(q.error) + ", ";
  return text + q.description + '\n';
}

// Spots that enter all over a slot of width W make profiles wider there by W²/12, beside R²/5 of their size and c²/12
// of the kernel; DEM's may be narrower than even spots from the middle would make them.
std::string entry_text(const Pipeline& pipeline, const Table& calibration) {
  const double slot = number(pipeline, "slot_width"), radius = number_of(calibration, "radius").value;
  const double halfway = slot * slot / 24 + radius * radius / 5 + pipeline.cutoff * pipeline.cutoff / 12;
  const Quantity& offset = number_of(calibration, "offset");
  const bool narrow = offset.value + 2 * offset.error < halfway;
  std::string text = std::string("  entry: ") + (narrow ? "centre" : "spread") + "  # profiles have a variance of " +
                     short_number(offset.value);
  if (std::isfinite(offset.error)) text += " +- " + short_number(offset.error);
  return text + " at the slot\n";
}

std::string spots_text(const Pipeline& pipeline, const Table& calibration, double diameter) {
  const Quantity& side = number_of(calibration, "step_side");
  const std::string dx = short_number(side.value);
  std::string text = "\nspots:\n" + line("radius", number_of(calibration, "radius")) +
                     line("influence", number_of(calibration, "influence")) + "  step: [" + dx + ", " + dx + ", " +
                     short_number(number_of(calibration, "step_up").value) + "]  # ";
  if (std::isfinite(side.error)) text += "+- " + short_number(side.error) + " to the sides, ";
  const Quantity &b = number_of(calibration, "b"), &volume = number_of(calibration, "volume");
  text += "b = " + short_number(b.value) + (std::isfinite(b.error) ? " +- " + short_number(b.error) : "") + '\n' +
          line("hop_rate", number_of(calibration, "hop_rate")) +
          line("insertion_rate", number_of(calibration, "insertion_rate")) + entry_text(pipeline, calibration) +
          "  wall_distance: " + short_number(diameter) +
          "  # one diameter; not measured\n  # V_s/V_p = " + short_number(volume.value);
  if (std::isfinite(volume.error)) text += " +- " + short_number(volume.error);
  return text + '\n';
}

// The zone is a diameter wider than a spot, but where a period is too short to hold that. What of spots that do not fit
// themselves is left to the reader of the file to refuse.
std::string relaxation_text(const Box& box, double radius, double diameter) {
  double half = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
    if (box.periodic[a]) half = std::min(half, 0.5 * box.length(a));
  std::string text = "\nrelaxation:\n  every: 1\n  strength: 0.8\n";
  if (radius <= half && half < radius + diameter)
    text += "  radius: " + print_number(half) + "  # half the period; a diameter more than spots.radius is too long\n";
  return text;
}

// Without the rounding of a product.
double to_ten_digits(double x) {
  const double scale = std::pow(10, 10 - std::ceil(std::log10(x)));
  return std::round(x * scale) / scale;
}

std::string output_text(const std::vector<std::size_t>& frames, const FrameSource& source) {
  const auto &first = source.frames()[frames.front()].time, &last = source.frames()[frames.back()].time;
  const double steps = static_cast<double>(frames.size()) - 1;
  const double interval = std::stod(short_number((*last - *first) / steps));
  const double end = to_ten_digits(steps * interval);
  std::string text = "\noutput:\n  interval: " + print_number(interval) + "\n  end: " + print_number(end);
  if (find_unit_system(source.units().name) != nullptr) text += "\n  units: " + source.units().name;
  return text + "\n\nseed: 1\n";
}

}  // namespace

void check_calibration(const Pipeline& pipeline) {
  if (!pipeline.measure.contains(calibration_name))
    throw ConfigError({Location{pipeline.file},
                       "there is nothing to calibrate: the section 'measure.spot_calibration' is missing",
                       {},
                       "measure, with a section spot_calibration",
                       "'grainvdb measurements spot_calibration' explains its options"});
  if (!(number(pipeline, "slot_width") > 0))
    throw ConfigError({pipeline.location("measure.spot_calibration.slot_width"),
                       "the spot file needs the width of the slot: measure.spot_calibration.slot_width is 0",
                       {},
                       "a length above 0",
                       {}});
  if (pipeline.reduced)
    throw ConfigError({pipeline.location("output.reduced"),
                       "a spot file is in the units of its dumps",
                       "reduced units",
                       "a pipeline file without them",
                       {}});
  if (pipeline.select.ids)
    throw ConfigError({pipeline.location("select.ids"),
                       "a spot file chooses grains by their type and place, not by id",
                       {},
                       "select.types, select.region",
                       {}});
}

std::string calibrated_spot_file(const Pipeline& pipeline, const Table& calibration, FrameSource& source) {
  check_parameters(pipeline, calibration);
  const std::vector<std::size_t> frames = select_frames(pipeline.frames, source.frames().size());
  ColumnSet columns = Column::radius;
  if (!pipeline.select.types.empty()) columns |= Column::type;
  const Frame frame = source.read(frames.front(), columns);
  const Extent grains = extent_of(frame, pipeline.select.types, number(pipeline, "bottom"));
  if (grains.grains == 0)
    throw InputError({{frame.file}, "no grain of this dump lies above the floor", {}, {}, "Compare bottom and select"});
  const double diameter = 2 * frame.particles.radius.front();
  const Box box = container_of(pipeline, frame, grains);
  const double radius = number_of(calibration, "radius").value;
  return "# The spot model of " + pipeline.file + ", by grainvdb spot calibrate: " + calibration.description +
         ".\n# Numbers in the units of the dumps.\ngrainvdb: 1\n\n" + packing_text(pipeline, frames.front()) +
         container_text(pipeline, box) + spots_text(pipeline, calibration, diameter) +
         relaxation_text(box, radius, diameter) + output_text(frames, source);
}

}  // namespace grainvdb::spot
