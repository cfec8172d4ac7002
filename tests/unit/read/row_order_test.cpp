#include "read/row_order.hpp"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "support/random.hpp"

namespace grainvdb::row_order_test {
namespace {

using testing::Random;
using Keys = std::vector<std::int64_t>;

std::vector<std::uint32_t> expected_order(const Keys& first, const Keys& second) {
  std::vector<std::uint32_t> order(first.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return first[a] != first[b] ? first[a] < first[b] : second[a] < second[b];
  });
  return order;
}

std::vector<std::uint32_t> numbers(const RowOrder& order, std::size_t n) {
  if (order) return *order;
  std::vector<std::uint32_t> rows(n);
  std::iota(rows.begin(), rows.end(), 0U);
  return rows;
}

Keys random_keys(Random& random, std::size_t n, std::int64_t range) {
  Keys keys(n);
  for (std::int64_t& key : keys) key = 1 + static_cast<std::int64_t>(random.below(static_cast<std::size_t>(range)));
  return keys;
}

TEST(RowOrder, IsThatOfAStableSort) {
  Random random(5);
  for (const std::size_t n : {2U, 3U, 100U, 5000U})
    for (const std::int64_t range : {std::int64_t{1}, std::int64_t{3}, std::int64_t{100}, std::int64_t{6000},
                                     std::int64_t{1} << 30, (std::int64_t{1} << 53) - 1}) {
      const Keys a = random_keys(random, n, range), b = random_keys(random, n, range), none(n, 0);
      EXPECT_EQ(numbers(ascending(a), n), expected_order(a, none)) << n << ' ' << range;
      EXPECT_EQ(numbers(ascending(a, b), n), expected_order(a, b)) << n << ' ' << range;
    }
}

TEST(RowOrder, PlacesDistinctIds) {
  Random random(6);
  Keys ids(10'000);
  std::iota(ids.begin(), ids.end(), 7);
  for (std::size_t i = ids.size() - 1; i > 0; --i) std::swap(ids[i], ids[random.below(i + 1)]);
  EXPECT_EQ(numbers(ascending(ids), ids.size()), expected_order(ids, ids));
}

TEST(RowOrder, IsNothingWhereRowsAreInOrder) {
  EXPECT_FALSE(ascending(Keys{}));
  EXPECT_FALSE(ascending(Keys{5}));
  EXPECT_FALSE(ascending(Keys{1, 1, 2}));
  EXPECT_FALSE(ascending(Keys{}, Keys{}));
  EXPECT_FALSE(ascending(Keys{1, 1, 2}, Keys{4, 4, 1}));
  EXPECT_TRUE(ascending(Keys{1, 1, 2}, Keys{5, 4, 1}));
}

TEST(RowOrder, MovesAllColumns) {
  // Enough rows for several threads.
  constexpr std::size_t n = 50'000;
  DumpTable table;
  table.rows = n;
  table.whole.resize(1);
  table.real.resize(2);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t id = (i * 7919) % n;
    table.whole[0].push_back(static_cast<std::int64_t>(id));
    table.real[0].push_back(static_cast<double>(id) + 0.5);
    table.real[1].push_back(-static_cast<double>(id));
  }
  reorder(table, ascending(table.whole[0]));
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_EQ(table.whole[0][i], static_cast<std::int64_t>(i));
    ASSERT_EQ(table.real[0][i], static_cast<double>(i) + 0.5);
    ASSERT_EQ(table.real[1][i], -static_cast<double>(i));
  }
}

}  // namespace
}  // namespace grainvdb::row_order_test
