#include <gmock/gmock.h>

#include "grainvdb/field_sink.hpp"

namespace grainvdb::sink_registry_test {
namespace {

TEST(SinkRegistry, ListsTheFormats) {
  std::vector<std::string> names;
  for (const SinkInfo& s : sink_registry()) {
    names.push_back(s.name);
    EXPECT_FALSE(s.description.empty());
    EXPECT_NE(s.make("somewhere"), nullptr);
  }
  EXPECT_THAT(names, ::testing::ElementsAre("hdf5", "vdb"));
}

}  // namespace
}  // namespace grainvdb::sink_registry_test
