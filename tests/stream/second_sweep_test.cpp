// A second sweep reads again what it needs, and nothing else.
#include <cstddef>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grainvdb/frame_source.hpp"
#include "support/memory_source.hpp"
#include "support/run_in_memory.hpp"
#include "support/sample_dumps.hpp"
#include "support/scenes.hpp"

namespace grainvdb::testing::second_sweep_test {
namespace {

/// Notes what each frame is read for.
class NotingSource : public MemorySource {
 public:
  using MemorySource::MemorySource;
  Frame read(std::size_t k, ColumnSet wanted) override {
    reads.emplace_back(k, wanted);
    return MemorySource::read(k, wanted);
  }
  std::vector<std::pair<std::size_t, ColumnSet>> reads;
};

class SecondSweep : public ::testing::Test {
 protected:
  SecondSweep() {
    pipeline_.input.contacts.files = {"memory"};
    pipeline_.limits.frames_in_flight = 1;
  }
  Scene scene_ = walled_scene();
  Pipeline pipeline_ = scene_.pipeline({"phi", "stress", "temperature"});
};

// The kinetic stress about the mean velocity needs mass and velocity; volumes, spins and contacts are summed already.
TEST_F(SecondSweep, ReadsOnlyTheColumnsItNeeds) {
  NotingSource source(scene_.frames);
  const std::size_t frames = scene_.frames.size();
  run(pipeline_, source);
  ASSERT_EQ(source.reads.size(), 2 * frames);
  const ColumnSet first = Column::velocity | Column::radius | ColumnSet(Column::contacts);
  const ColumnSet second = Column::velocity | Column::mass;
  for (std::size_t n = 0; n < source.reads.size(); ++n) {
    EXPECT_EQ(source.reads[n].first, n % frames);
    const ColumnSet select = pipeline_.select.types.empty() ? ColumnSet() : ColumnSet(Column::type);
    EXPECT_EQ(source.reads[n].second, (n < frames ? first : second) | select) << n;
  }
}

TEST(SecondSweepOfDumps, OpensNoContactsAgain) {
  const auto rows_of = [](std::vector<std::string> fields) {
    Pipeline p = shear_cell_pipeline(std::move(fields));
    const auto source = open_dumps(p.input);
    return run(p, *source).report.read.rows_read;
  };
  // Contacts once, particles once for each sweep.
  EXPECT_EQ(rows_of({"stress"}), rows_of({"contact_stress"}) + rows_of({"phi"}));
}

}  // namespace
}  // namespace grainvdb::testing::second_sweep_test
