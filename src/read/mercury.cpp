#include "read/mercury.hpp"

#include <cmath>
#include <limits>

#include "grainvdb/error.hpp"
#include "read/file_number.hpp"
#include "read/number.hpp"

namespace grainvdb::mercury {

std::optional<std::vector<double>> numbers(std::string_view line) {
  std::vector<double> values;
  for (std::string_view token = take_token(line); !token.empty(); token = take_token(line)) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!parse_real(token, value) && token != "nan" && token != "-nan") return std::nullopt;
    values.push_back(value);
  }
  return values;
}

std::int64_t first_step(const std::string& file) {
  for (const char* name : {".data.", ".fstat."})
    if (file.find(name, file.rfind('/') + 1) != std::string::npos) return number_at_end(file).value_or(0);
  return 0;
}

void set_bounds(Box& box, std::size_t axis, double lo, double hi, const LineReader& lines) {
  if (!(lo < hi) || !std::isfinite(hi - lo))
    throw InputError({{lines.file(), lines.line_number()},
                      std::string("the box is empty along ") + "xyz"[axis],
                      std::to_string(lo) + " ... " + std::to_string(hi),
                      "a lower and a higher bound",
                      {}});
  box.lo[axis] = lo;
  box.hi[axis] = hi;
}

}  // namespace grainvdb::mercury
