#pragma once
#include "grainvdb/box.hpp"

namespace grainvdb {

inline double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace grainvdb
