// Runs the benchmarks. `--check` only compares their results, on a small scene; `--quick` takes smaller scenes.
#include <cstdio>
#include <exception>
#include <string_view>

#include <benchmark/benchmark.h>
#include <openvdb/openvdb.h>
#include <tbb/version.h>

#include "check.hpp"
#include "contact_bench.hpp"
#include "growth_bench.hpp"
#include "library_paths.hpp"
#include "machine.hpp"
#include "run_bench.hpp"
#include "splat_bench.hpp"
#include "spot_bench.hpp"
#include "threads.hpp"
#include "tracer_bench.hpp"

namespace grainvdb::bench {
namespace {

int check_results() {
  check_splat(tiny_sizes());
  check_contacts(tiny_sizes());
  check_run(tiny_sizes());
  check_tracers(tiny_sizes());
  check_spots(tiny_sizes());
  return all_checks_succeeded() ? 0 : 1;
}

void describe_build() {
  benchmark::AddCustomContext("instruction_set", instruction_set());
  benchmark::AddCustomContext("compiler", GRAINVDB_BENCH_COMPILER);
  benchmark::AddCustomContext("flags", GRAINVDB_BENCH_FLAGS);
  benchmark::AddCustomContext("openvdb", OPENVDB_LIBRARY_VERSION_STRING);
  benchmark::AddCustomContext("tbb", TBB_VERSION_STRING);
}

}  // namespace
}  // namespace grainvdb::bench

int main(int argc, char** argv) {
  using namespace grainvdb::bench;
  try {
    openvdb::initialize();
    use_threads(1);
    const std::string_view mode = argc > 1 ? argv[1] : "";
    if (mode == "--check") return check_results();
    const bool quick = mode == "--quick";
    const Sizes sizes = quick ? quick_sizes() : Sizes();
    if (quick) {
      argv[1] = argv[0];
      --argc;
      ++argv;
    }
    register_splat(sizes);
    register_contacts(sizes);
    register_machine();
    register_growth(sizes);
    register_memory(sizes);
    register_run(sizes);
    register_tracers(sizes);
    register_spots(sizes);
    describe_build();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return all_checks_succeeded() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
