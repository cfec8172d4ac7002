#include "pipeline/average_keys.hpp"

#include <cstdint>
#include <string>

namespace grainvdb {

void add_average_keys(Schema& schema) {
  schema.sections.push_back({"average", "Averages over time."});
  KeyInfo window{"average", "window", ValueType::window,
                 "Frames per output time; 'all' makes one mean of all frames, 'none' an output time of each frame. The "
                 "last output time may have fewer."};
  window.default_value = std::string("all");
  window.minimum = 1;
  window.apply = [](Pipeline& p, const ConfigValue& v) {
    const auto* count = std::get_if<std::int64_t>(&v);
    p.window = count != nullptr ? static_cast<std::size_t>(*count) : std::get<std::string>(v) == "none" ? 1 : 0;
  };
  schema.keys.push_back(window);
  KeyInfo step{"average", "step", ValueType::integer,
               "Frames from the beginning of one output time to that of the next; as many as average.window unless "
               "given. Fewer make windows that slide, more leave out the frames in between."};
  step.minimum = 1;
  step.apply = [](Pipeline& p, const ConfigValue& v) {
    p.window_step = static_cast<std::size_t>(std::get<std::int64_t>(v));
  };
  schema.keys.push_back(step);
  KeyInfo blocks{"average", "blocks", ValueType::integer,
                 "Blocks of successive frames that each output time is divided into for standard errors (the fields "
                 "NAME_error), which hold where a block is longer than motion is correlated. B blocks give an error "
                 "to 1 part in sqrt(2(B-1))."};
  blocks.default_value = static_cast<std::int64_t>(Pipeline().blocks);
  blocks.minimum = 2;
  blocks.maximum = 1000;
  blocks.apply = [](Pipeline& p, const ConfigValue& v) {
    p.blocks = static_cast<std::size_t>(std::get<std::int64_t>(v));
  };
  schema.keys.push_back(blocks);
}

}  // namespace grainvdb
