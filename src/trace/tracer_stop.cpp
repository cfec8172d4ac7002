#include "grainvdb/tracer_sink.hpp"

namespace grainvdb {

std::string_view name_of(TracerStop stop) {
  switch (stop) {
    case TracerStop::moving:
      return "moving";
    case TracerStop::left_material:
      return "left_material";
    case TracerStop::left_domain:
      return "left_domain";
    case TracerStop::masked:
      return "masked";
  }
  return "unknown";
}

}  // namespace grainvdb
