// Writes the scene of the sinks' own tests, so that the Python reader is tested on a file that the sink has made.
#include <iostream>

#include "unit/write/tracer_scene.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: " << argv[0] << " FOLDER\n";
    return 1;
  }
  const auto sink = grainvdb::testing::make_tracer_sink("h5md", argv[1]);
  grainvdb::testing::TracerScene{}.write_all(*sink);
  sink->commit(grainvdb::testing::some_provenance());
  return 0;
}
