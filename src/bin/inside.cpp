#include "bin/inside.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace grainvdb {
namespace {

template <class T>
void keep_rows(std::vector<T>& column, const std::vector<std::size_t>& rows) {
  if (column.empty()) return;
  std::vector<T> kept;
  kept.reserve(rows.size());
  for (const std::size_t n : rows) kept.push_back(column[n]);
  column = std::move(kept);
}

void keep_rows(Columns3& columns, const std::vector<std::size_t>& rows) {
  for (std::vector<double>& column : columns) keep_rows(column, rows);
}

/// In ascending order.
std::vector<std::size_t> rows_inside(const WallDomain& domain, const Columns3& place) {
  std::vector<std::size_t> rows;
  for (std::size_t n = 0; n < place[0].size(); ++n)
    if (domain.contains({place[0][n], place[1][n], place[2][n]})) rows.push_back(n);
  return rows;
}

}  // namespace

void keep_inside(const WallDomain& domain, Particles& p) {
  const std::vector<std::size_t> rows = rows_inside(domain, p.position);
  if (rows.size() == p.size()) return;
  keep_rows(p.id, rows);
  for (Columns3* columns : {&p.position, &p.velocity, &p.angular_velocity}) keep_rows(*columns, rows);
  keep_rows(p.radius, rows);
  keep_rows(p.mass, rows);
  keep_rows(p.type, rows);
  keep_rows(p.species, rows);
}

void keep_inside(const WallDomain& domain, HalfBranches& b) {
  std::vector<std::size_t> rows = rows_inside(domain, b.start);
  if (rows.size() == b.size()) return;
  std::stable_partition(rows.begin(), rows.end(),
                        [all = rows](std::size_t n) { return std::binary_search(all.begin(), all.end(), n ^ 1U); });
  for (Columns3* columns : {&b.start, &b.arm, &b.force}) keep_rows(*columns, rows);
  keep_rows(b.species, rows);
}

}  // namespace grainvdb
