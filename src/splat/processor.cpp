#include "splat/processor.hpp"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace grainvdb {

bool halves_wide_registers() {
#if defined(__x86_64__)
  static const bool halves = [] {
    unsigned a = 0, b = 0, c = 0, d = 0;
    if (__get_cpuid(0, &a, &b, &c, &d) == 0) return false;
    const bool amd = b == signature_AMD_ebx && c == signature_AMD_ecx && d == signature_AMD_edx;
    if (__get_cpuid(1, &a, &b, &c, &d) == 0) return false;
    const unsigned family = (a >> 8U & 0xfU) + (a >> 20U & 0xffU);
    return amd && family == 0x19;  // Zen 4: those before it have no such registers, Zen 5 has units as wide
  }();
  return halves;
#else
  return false;
#endif
}

}  // namespace grainvdb
