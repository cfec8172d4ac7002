#pragma once
/// A small registry of stages of every shape, pipeline files in a temporary folder, and errors as texts.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grainvdb/pipeline.hpp"

namespace grainvdb::test {

/// phi and velocity (one pass), temperature (two passes), kinetic_stress (a time mean first), contact_stress, stress
/// (made from these two), mu (from stress; options of each type).
StageRegistry example_registry();

/// A stage without a computation that needs the given fields and moments.
Stage example_stage(const std::string& name, std::vector<std::string> fields, std::vector<MomentPtr> moments);

MomentPtr example_moment(Moment moment);

/// A file that is removed when the object goes.
class PipelineFile {
 public:
  explicit PipelineFile(const std::string& text);
  ~PipelineFile();
  PipelineFile(const PipelineFile&) = delete;
  PipelineFile& operator=(const PipelineFile&) = delete;

  const std::string& path() const { return path_; }
  std::string folder() const;

 private:
  std::string path_;
};

/// A complete pipeline file; line numbers in tests refer to it:
///   1 grainvdb   2 input   3 particles   4 lattice   5 voxel   6 kernel   7 cutoff   8 output   9 fields
std::string minimal_text();

Pipeline load(const std::string& text, const std::vector<std::string>& overrides = {});

/// The message of the ConfigError that loading ends with, the path of the file cut to "FILE". Fails the test when there
/// is none.
std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {});

}  // namespace grainvdb::test
