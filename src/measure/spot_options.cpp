#include "measure/spot_options.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include "measure/counted_region.hpp"
#include "measure/option_values.hpp"

namespace grainvdb {

OptionInfo reference_option() {
  return {.name = "reference",
          .default_value = std::string("rest"),
          .help =
              "what the flow is looser than: the packing at rest, or (layers) what the line through packing fraction "
              "and flux of layers of the box comes to without flux",
          .choices = {"rest", "layers"}};
}

OptionInfo flow_from_option() {
  return {.name = "flow_from",
          .default_value = std::int64_t{0},
          .help = "step of the first frame of the steady flow; those between the first and it count for nothing"};
}

OptionInfo phi_at_rest_option() {
  return {.name = "phi_at_rest",
          .default_value = 0.0,
          .help = "packing fraction of the box at rest; 0: that of the first frame, which is then no part of the flow",
          .minimum = 0,
          .maximum = 1};
}

SmoothBox smooth_box(const OptionValues& options) {
  const std::vector<double>&lo = numbers_option(options, "lo"), &hi = numbers_option(options, "hi");
  return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

Loosening::Reference reference_of(const OptionValues& options) {
  const bool rest = std::get<std::string>(options.at("reference")) == "rest";
  return rest ? Loosening::Reference::rest : Loosening::Reference::layers;
}

std::optional<OptionConflict> whole_box_conflict(const OptionValues& options) {
  for (const std::string name : {"lo", "hi"})
    if (numbers_option(options, name).empty())
      return OptionConflict{name, "none", "three numbers: a box within the material"};
  return CountedRegion::conflict(options);
}

}  // namespace grainvdb
