#pragma once
/// Planes that fields are averaged over.

namespace grainvdb {

struct Planes {
  int axis = 2;     ///< their normal
  double area = 0;  ///< of each [length²]; 0: that of the box
};

}  // namespace grainvdb
