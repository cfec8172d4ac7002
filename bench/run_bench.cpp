#include "run_bench.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

#include <benchmark/benchmark.h>
#include <stdlib.h>

#include "check.hpp"
#include "dumps.hpp"
#include "library_paths.hpp"
#include "threads.hpp"

namespace grainvdb::bench {
namespace {

/// Dumps in a temporary folder that goes when the program ends.
class Dumps {
 public:
  explicit Dumps(const Sizes& sizes) {
    std::string name = (std::filesystem::temp_directory_path() / "grainvdb_bench.XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make the folder " + name);
    folder_ = name;
    pipeline_ = write_dumps(sizes.contact_particles, sizes.frames, name);
  }
  Dumps(const Dumps&) = delete;
  Dumps& operator=(const Dumps&) = delete;
  ~Dumps() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// Runs the pipeline and returns the path of the result.
  std::string run(std::size_t threads) const {
    use_threads(threads);
    const std::string output = (folder_ / std::to_string(threads)).string();
    std::filesystem::create_directories(output);
    run_pipeline_file(pipeline_, output);
    use_threads(1);
    return output + "/fields.hdf";
  }

 private:
  std::filesystem::path folder_;
  std::string pipeline_;
};

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool check(const Dumps& dumps) {
  return check_once("run/threads=1 and run/threads=2", [&] {
    const std::string one = bytes_of(dumps.run(1));
    return !one.empty() && one == bytes_of(dumps.run(2)) ? 0.0 : std::numeric_limits<double>::infinity();
  });
}

}  // namespace

void register_run(const Sizes& sizes) {
  for (const std::size_t threads : {1, 2})
    benchmark::RegisterBenchmark(("run/threads=" + std::to_string(threads)).c_str(),
                                 [=](benchmark::State& state) {
                                   static const Dumps dumps(sizes);
                                   if (!check(dumps)) return state.SkipWithError("the results disagree");
                                   for (auto _ : state) dumps.run(threads);
                                   state.counters["particles"] = static_cast<double>(sizes.contact_particles);
                                   state.counters["frames"] = static_cast<double>(sizes.frames);
                                 })
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
}

void check_run(const Sizes& sizes) {
  check(Dumps(sizes));
}

}  // namespace grainvdb::bench
