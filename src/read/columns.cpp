#include "read/columns.hpp"

#include "read/text.hpp"

namespace grainvdb {
namespace {

/// The index of a column in a request, which grows when the column is new to it.
std::size_t put(std::vector<std::size_t>& request, std::size_t column) {
  const auto it = std::find(request.begin(), request.end(), column);
  const auto index = static_cast<std::size_t>(it - request.begin());
  if (it == request.end()) request.push_back(column);
  return index;
}

}  // namespace

bool ColumnFinder::has(std::string_view name) const {
  return std::find(header_.columns.begin(), header_.columns.end(), name) != header_.columns.end();
}

bool ColumnFinder::has_all(const std::array<std::string, 3>& names) const {
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) { return has(name); });
}

std::size_t ColumnFinder::find(std::string_view name) const {
  const auto& columns = header_.columns;
  if (std::count(columns.begin(), columns.end(), name) > 1)
    throw InputError({location(), "two columns are named " + std::string(name), names(), "one", {}});
  return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
}

std::size_t ColumnFinder::real(std::string_view name) {
  return put(request_.real, find(name));
}

std::size_t ColumnFinder::whole(std::string_view name) {
  return put(request_.whole, find(name));
}

std::array<std::size_t, 3> ColumnFinder::real3(const std::array<std::string, 3>& names) {
  return {real(names[0]), real(names[1]), real(names[2])};
}

std::string ColumnFinder::names() const {
  return joined(header_.columns);
}

Location stated_at(const InputSpec& spec, std::string key) {
  for (;;) {
    const auto it = spec.where.find(key);
    if (it != spec.where.end()) return it->second;
    const std::size_t dot = key.rfind('.');
    if (dot == std::string::npos) return {};
    key.resize(dot);
  }
}

void check_ids(const std::vector<std::int64_t>& ids, std::string_view column, const DumpTable& table,
               const std::string& file) {
  constexpr std::int64_t limit = std::int64_t{1} << 53;
  const auto bad = std::find_if(ids.begin(), ids.end(), [](std::int64_t id) { return id < 1 || id >= limit; });
  if (bad == ids.end()) return;
  const auto row = static_cast<std::size_t>(bad - ids.begin());
  throw InputError({{file, table.line(row)},
                    "bad value in column " + std::string(column),
                    std::to_string(*bad),
                    "an id from 1 to 2^53 - 1",
                    {}});
}

}  // namespace grainvdb
