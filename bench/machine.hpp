#pragma once
/// What the machine can do: the roof that kernels are measured against.
#include <cstddef>

namespace grainvdb::bench {

/// Fused multiply-adds in single precision on independent registers, in the widest vectors that the library uses on
/// this machine, and how many were done. Nothing is loaded or stored in between.
std::size_t multiply_add(std::size_t rounds);

/// Its instruction set.
const char* multiply_add_target();

/// a[i] = b[i] + 3 c[i].
void triad(float* a, const float* b, const float* c, std::size_t n);

/// kernel/peak_fma and machine/triad.
void register_machine();

}  // namespace grainvdb::bench
