#pragma once
#include <sys/resource.h>

namespace grainvdb::cli {

/// Of this process so far [byte].
inline double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024;
}

}  // namespace grainvdb::cli
