#include "base/ordered_pipeline.hpp"

#include <atomic>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/parallel.hpp"

namespace grainvdb::ordered_pipeline_test {
namespace {

constexpr std::size_t items = 200;

std::vector<std::size_t> all_items() {
  std::vector<std::size_t> all(items);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

class OrderedPipeline : public ::testing::TestWithParam<std::size_t> {
  tbb::global_control threads_{tbb::global_control::max_allowed_parallelism, 4};
};

TEST_P(OrderedPipeline, BeginsAndFinishesInOrder) {
  std::vector<std::size_t> begun;
  std::vector<std::size_t> finished;
  std::atomic<std::size_t> on_their_way = 0;
  std::atomic<std::size_t> most = 0;
  ordered_pipeline(
      items, GetParam(),
      [&](std::size_t i) {
        begun.push_back(i);
        const std::size_t now = ++on_their_way;
        if (now > most) most = now;
        return i;
      },
      [](std::size_t i, std::size_t x) {
        std::vector<double> work(1000 * (i % 7));
        parallel_for(work.size(), [&](std::size_t k) { work[k] = static_cast<double>(k); });
        return std::to_string(x);
      },
      [&](std::size_t i, const std::string& text) {
        EXPECT_EQ(text, std::to_string(i));
        finished.push_back(i);
        --on_their_way;
      });
  EXPECT_EQ(begun, all_items());
  EXPECT_EQ(finished, all_items());
  EXPECT_LE(most, GetParam());
}

TEST_P(OrderedPipeline, ThrowsWhatTheFirstItemThrows) {
  // Item 60 fails early in its way, but item 50 comes before it, and item 40 before both.
  struct Failures {
    std::size_t begin, prepare, finish;
    const char* what;
  };
  for (const Failures& f : {Failures{60, 50, 40, "finish 40"}, Failures{60, 50, items, "prepare 50"},
                            Failures{60, 70, 80, "begin 60"}, Failures{0, 0, 0, "begin 0"}}) {
    SCOPED_TRACE(f.what);
    std::size_t finished = 0;
    const auto fail = [](const char* where, std::size_t i, std::size_t at) {
      if (i == at) throw std::runtime_error(where + std::to_string(i));
      return i;
    };
    try {
      ordered_pipeline(
          items, GetParam(), [&](std::size_t i) { return fail("begin ", i, f.begin); },
          [&](std::size_t i, std::size_t) { return fail("prepare ", i, f.prepare); },
          [&](std::size_t i, std::size_t) { finished = fail("finish ", i, f.finish) + 1; });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), f.what);
    }
    EXPECT_EQ(finished, std::min({f.begin, f.prepare, f.finish}));
  }
}

TEST_P(OrderedPipeline, BeginsNothingAfterAFailureToBegin) {
  std::size_t last = 0;
  EXPECT_THROW(ordered_pipeline(
                   items, GetParam(),
                   [&](std::size_t i) {
                     last = i;
                     if (i == 7) throw std::runtime_error("no more");
                     return i;
                   },
                   [](std::size_t, std::size_t x) { return x; }, [](std::size_t, std::size_t) {}),
               std::runtime_error);
  EXPECT_EQ(last, 7U);
}

TEST(OrderedPipelineOfNothing, CallsNothing) {
  const auto never = [](std::size_t, auto...) -> int { throw std::logic_error("called"); };
  EXPECT_NO_THROW(ordered_pipeline(
      0, 3, [&](std::size_t i) { return never(i); }, [&](std::size_t i, int x) { return never(i, x); },
      [&](std::size_t i, int x) { never(i, x); }));
}

INSTANTIATE_TEST_SUITE_P(InFlight, OrderedPipeline, ::testing::Values(1U, 2U, 3U, 16U));

}  // namespace
}  // namespace grainvdb::ordered_pipeline_test
