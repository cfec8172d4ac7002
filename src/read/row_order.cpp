#include "read/row_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <string>

#include "base/parallel.hpp"
#include "grainvdb/error.hpp"
#include "read/huge_pages.hpp"

namespace grainvdb {
namespace {

/// Fewer rows are moved faster than threads start.
constexpr std::size_t worth_threads = std::size_t{1} << 15;

/// Rows are numbered with 32 bits, of which one number stands for none.
void check_count(std::size_t rows) {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  if (rows >= most)
    throw LimitError({{}, "too many rows in one frame", std::to_string(rows), "fewer than 2^32 - 1", {}});
}

struct Keyed {
  std::uint64_t key;
  std::uint32_t row;
};

/// Sorts by the lowest `bits` of the keys, digit by digit from the last; equal keys stay as they are.
void radix_sort(std::vector<Keyed>& rows, int bits) {
  constexpr int digit_bits = 11;
  constexpr std::uint64_t mask = (std::uint64_t{1} << digit_bits) - 1;
  std::vector<Keyed> sorted(rows.size());
  for (int shift = 0; shift < bits; shift += digit_bits) {
    std::array<std::size_t, mask + 1> place{};
    for (const Keyed& row : rows) ++place[row.key >> shift & mask];
    std::exclusive_scan(place.begin(), place.end(), place.begin(), std::size_t{0});
    for (const Keyed& row : rows) sorted[place[row.key >> shift & mask]++] = row;
    rows.swap(sorted);
  }
}

std::vector<std::uint32_t> numbers_of(const std::vector<Keyed>& rows) {
  std::vector<std::uint32_t> order(rows.size());
  std::transform(rows.begin(), rows.end(), order.begin(), [](const Keyed& row) { return row.row; });
  return order;
}

/// What is taken off keys so that they need few bits, and how many they need then.
struct KeyRange {
  std::uint64_t low = 0, width = 0;
  int bits = 0;

  explicit KeyRange(const std::vector<std::int64_t>& key) {
    const auto [least, most] = std::minmax_element(key.begin(), key.end());
    low = static_cast<std::uint64_t>(*least);
    width = static_cast<std::uint64_t>(*most) - low;
    bits = std::bit_width(width);
  }
  std::uint64_t of(std::int64_t key) const { return static_cast<std::uint64_t>(key) - low; }
};

/// The order of keys that nearly fill their range and differ, found by writing each row to its place; nothing when two
/// are equal.
RowOrder placed(const std::vector<std::int64_t>& key, const KeyRange& range) {
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> place(range.width + 1, none);
  for (std::size_t i = 0; i < key.size(); ++i) {
    std::uint32_t& to = place[range.of(key[i])];
    if (to != none) return std::nullopt;
    to = static_cast<std::uint32_t>(i);
  }
  place.erase(std::remove(place.begin(), place.end(), none), place.end());
  return place;
}

template <class T>
void reorder_columns(std::vector<std::vector<T>>& columns, const std::vector<std::uint32_t>& order) {
  if (columns.empty()) return;
  std::vector<T> moved;
  reserve_pages(moved, order.size());
  moved.resize(order.size());
  for (std::vector<T>& column : columns) {
    const auto move = [from = column.data(), to = moved.data(), row = order.data()](std::size_t begin,
                                                                                    std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) to[i] = from[row[i]];
    };
    if (order.size() < worth_threads)
      move(0, order.size());
    else
      parallel_ranges(order.size(), move);
    column.swap(moved);
  }
}

}  // namespace

RowOrder ascending(const std::vector<std::int64_t>& key) {
  if (std::is_sorted(key.begin(), key.end())) return std::nullopt;
  check_count(key.size());
  const KeyRange range(key);
  if (range.width < 4 * key.size())
    if (RowOrder order = placed(key, range)) return order;
  std::vector<Keyed> rows(key.size());
  for (std::size_t i = 0; i < key.size(); ++i) rows[i] = {range.of(key[i]), static_cast<std::uint32_t>(i)};
  radix_sort(rows, range.bits);
  return numbers_of(rows);
}

RowOrder ascending(const std::vector<std::int64_t>& first, const std::vector<std::int64_t>& second) {
  const auto less = [&](std::size_t a, std::size_t b) {
    return first[a] != first[b] ? first[a] < first[b] : second[a] < second[b];
  };
  std::size_t sorted = 1;
  while (sorted < first.size() && !less(sorted, sorted - 1)) ++sorted;
  if (sorted >= first.size()) return std::nullopt;
  check_count(first.size());

  const KeyRange range1(first), range2(second);
  if (range1.bits + range2.bits <= 64) {
    std::vector<Keyed> rows(first.size());
    // A shift by 64 would be needed only where all of `first` are equal.
    const int shift = range1.bits == 0 ? 0 : range2.bits;
    for (std::size_t i = 0; i < rows.size(); ++i)
      rows[i] = {range1.of(first[i]) << shift | range2.of(second[i]), static_cast<std::uint32_t>(i)};
    radix_sort(rows, range1.bits + range2.bits);
    return numbers_of(rows);
  }
  std::vector<std::uint32_t> order(first.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::stable_sort(order.begin(), order.end(), less);
  return order;
}

void reorder(DumpTable& table, const RowOrder& order) {
  if (!order) return;
  reorder_columns(table.real, *order);
  reorder_columns(table.whole, *order);
}

}  // namespace grainvdb
