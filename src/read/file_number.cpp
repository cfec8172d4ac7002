#include "read/file_number.hpp"

#include <charconv>
#include <system_error>

namespace grainvdb {

std::optional<std::int64_t> number_at_end(std::string_view file) {
  for (const std::string_view extension : {".gz", ".zst", ".vtk"})
    if (file.ends_with(extension)) file.remove_suffix(extension.size());
  const std::size_t before = file.find_last_not_of("0123456789");
  const std::string_view digits = before == std::string_view::npos ? file : file.substr(before + 1);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || error != std::errc()) return std::nullopt;
  return number;
}

}  // namespace grainvdb
