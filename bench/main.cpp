// Runs the benchmarks, or with --check only the comparisons of their results, on a small scene.
#include <cstdio>
#include <exception>
#include <string_view>

#include <benchmark/benchmark.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>

#include "check.hpp"
#include "library_paths.hpp"
#include "splat_bench.hpp"

int main(int argc, char** argv) {
  using namespace grainvdb::bench;
  try {
    openvdb::initialize();
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    if (argc == 2 && std::string_view(argv[1]) == "--check") {
      check_splat({.particles = 500});
      return all_checks_succeeded() ? 0 : 1;
    }
    register_splat({});
    benchmark::AddCustomContext("splat_target", instruction_set());
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return all_checks_succeeded() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
