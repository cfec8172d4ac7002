#pragma once
/// Where the progress of a run is shown.
#include "grainvdb/run.hpp"

namespace grainvdb::cli {

class ProgressView {
 public:
  virtual ~ProgressView() = default;
  virtual void show(const Progress& progress) = 0;
};

}  // namespace grainvdb::cli
