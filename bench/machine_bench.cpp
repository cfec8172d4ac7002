#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <benchmark/benchmark.h>
#include <hwy/aligned_allocator.h>

#include "machine.hpp"

namespace grainvdb::bench {
namespace {

void peak_fma(benchmark::State& state) {
  std::size_t done = 0;
  for (auto _ : state) done += multiply_add(1'000'000);
  state.counters["fma/s"] = benchmark::Counter(static_cast<double>(done), benchmark::Counter::kIsRate);
  state.SetLabel(multiply_add_target());
}

void memory_triad(benchmark::State& state) {
  const std::size_t n = std::size_t{64} << 20;  // far more than any cache
  const auto make = [n](float value) {
    auto data = hwy::AllocateAligned<float>(n);
    std::fill_n(data.get(), n, value);
    return data;
  };
  const auto a = make(0), b = make(1), c = make(2);
  for (auto _ : state) {
    triad(a.get(), b.get(), c.get(), n);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * n * 3 * sizeof(float)));
}

}  // namespace

void register_machine() {
  benchmark::RegisterBenchmark("kernel/peak_fma", peak_fma)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("machine/triad", memory_triad)->Unit(benchmark::kMillisecond);
}

}  // namespace grainvdb::bench
