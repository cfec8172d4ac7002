#include "read/vtk_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "grainvdb/error.hpp"
#include "read/number.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

constexpr std::string_view signature = "# vtk DataFile Version ";
constexpr std::string_view version = "5.1";
constexpr std::size_t most_components = 64;

/// The bytes of a number, most significant first.
template <class T>
double from_big_endian(const char* bytes) {
  std::array<char, sizeof(T)> ordered{};
  std::memcpy(ordered.data(), bytes, sizeof(T));
  if constexpr (std::endian::native == std::endian::little) std::reverse(ordered.begin(), ordered.end());
  return static_cast<double>(std::bit_cast<T>(ordered));
}

struct NumberType {
  std::string_view name;
  std::size_t size;
  double (*from_big_endian)(const char* bytes);
};
constexpr std::array number_types{
    NumberType{"int", 4, &from_big_endian<std::int32_t>}, NumberType{"float", 4, &from_big_endian<float>},
    NumberType{"double", 8, &from_big_endian<double>}, NumberType{"vtktypeint64", 8, &from_big_endian<std::int64_t>}};

class VtkParser {
 public:
  VtkParser(std::string_view content, const std::string& file) : content_(content), file_(file) {}

  VtkFile parse() {
    read_first_lines();
    VtkFile result;
    result.points = {"points", 3, number_of("POINTS"), {}};
    read_values(result.points, word());
    skip_space();
    if (result.points.tuples == 0 && at_ == content_.size()) return result;
    read_cells();
    read_fields(result);
    skip_space();
    if (at_ != content_.size()) fail("there is something behind the data", in_quotes(rest()), "the end of the file");
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& found, const std::string& expected,
                         const std::string& hint = {}) const {
    throw InputError({{file_, 0}, what + " at byte " + std::to_string(at_), found, expected, hint});
  }
  [[noreturn]] void fail_cut_off() const {
    fail("the file ends within its data", {}, {}, "The file was cut off, or is still being written");
  }

  std::string_view rest() const { return content_.substr(at_); }
  static bool is_space(char c) { return is_blank(c) || c == '\n'; }
  void skip_space() {
    while (at_ < content_.size() && is_space(content_[at_])) ++at_;
  }
  std::string_view word() {
    skip_space();
    const std::size_t begin = at_;
    while (at_ < content_.size() && !is_space(content_[at_])) ++at_;
    if (at_ == content_.size()) fail_cut_off();
    return content_.substr(begin, at_ - begin);
  }
  std::string_view line() {
    const std::size_t newline = content_.find('\n', at_);
    if (newline == std::string_view::npos) fail_cut_off();
    std::string_view text = content_.substr(at_, newline - at_);
    at_ = newline + 1;
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
  }
  void expect(std::string_view wanted) {
    if (const std::string_view found = word(); found != wanted)
      fail("not what LIGGGHTS writes", in_quotes(found), std::string(wanted));
  }
  std::size_t count() {
    const std::string_view token = word();
    std::int64_t n = 0;
    if (!parse_whole(token, n) || n < 0) fail("a count that is no whole number", in_quotes(token), "0 or more");
    return static_cast<std::size_t>(n);
  }
  std::size_t number_of(std::string_view section) {
    expect(section);
    return count();
  }

  void read_first_lines() {
    const std::string_view first = line();
    if (first != std::string(signature) + std::string(version))
      fail("another version of the VTK format", in_quotes(first), std::string(signature) + std::string(version));
    line();
    const std::string_view encoding = line();
    if (encoding != "ASCII" && encoding != "BINARY") fail("unknown encoding", in_quotes(encoding), "ASCII or BINARY");
    binary_ = encoding == "BINARY";
    expect("DATASET");
    if (const std::string_view kind = word(); kind != "POLYDATA")
      fail("the file holds no grains or contacts", in_quotes(kind), "POLYDATA",
           "LIGGGHTS writes the box to files of their own, NAMEboundingBox_*: leave them out of the pattern");
  }

  /// Reads the values of an array whose sizes are known.
  void read_values(VtkArray& array, std::string_view type) {
    const auto known = std::find_if(number_types.begin(), number_types.end(),
                                    [&](const NumberType& candidate) { return candidate.name == type; });
    if (known == number_types.end())
      fail("the array " + array.name + " has another type of numbers", in_quotes(type),
           "int, float, double or vtktypeint64");
    if (array.tuples > content_.size() / array.components) fail_cut_off();
    const std::size_t n = array.tuples * array.components;
    if (binary_)
      read_binary(array, *known, n);
    else
      read_ascii(array, n);
  }

  void read_ascii(VtkArray& array, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view token = word();
      double value = 0;
      if (!parse_real(token, value))
        fail("bad value in the array " + array.name, in_quotes(token), "a finite decimal number");
      array.values.push_back(value);
    }
  }

  void read_binary(VtkArray& array, const NumberType& type, std::size_t n) {
    line();  // the bytes begin behind the line of the type
    if (n > rest().size() / type.size) fail_cut_off();
    for (std::size_t i = 0; i < n; ++i, at_ += type.size) {
      const double value = type.from_big_endian(content_.data() + at_);
      if (!std::isfinite(value)) fail("bad value in the array " + array.name, std::to_string(value), "a finite number");
      array.values.push_back(value);
    }
    if (at_ == content_.size() || content_[at_] != '\n') fail_cut_off();
  }

  /// Which points make up which cells is known: each its vertex, or two or three lines for each contact.
  void read_cells() {
    const std::string_view kind = word();
    if (kind != "VERTICES" && kind != "LINES") fail("unknown cells", in_quotes(kind), "VERTICES or LINES");
    VtkArray offsets{"OFFSETS", 1, count(), {}}, connectivity{"CONNECTIVITY", 1, count(), {}};
    for (VtkArray* array : {&offsets, &connectivity}) {
      expect(array->name);
      read_values(*array, word());
    }
  }

  void read_fields(VtkFile& result) {
    const std::string_view section = word();
    if (section != "POINT_DATA" && section != "CELL_DATA")
      fail("unknown section", in_quotes(section), "POINT_DATA or CELL_DATA");
    result.of_cells = section == "CELL_DATA";
    const std::size_t tuples = count();
    if (!result.of_cells && tuples != result.points.tuples)
      fail("the points do not have their data each", std::to_string(tuples), std::to_string(result.points.tuples));
    expect("FIELD");
    word();
    for (std::size_t left = count(); left > 0; --left) {
      VtkArray array{std::string(word()), count(), count(), {}};
      if (!is_name(array.name)) fail("a name that cannot be meant", in_quotes(array.name), "printable characters");
      if (array.components < 1 || array.components > most_components || array.tuples != tuples)
        fail("the array " + array.name + " has other sizes than the data",
             std::to_string(array.components) + " times " + std::to_string(array.tuples),
             "1 to " + std::to_string(most_components) + " times " + std::to_string(tuples));
      read_values(array, word());
      result.fields.push_back(std::move(array));
    }
  }

  std::string_view content_;
  const std::string& file_;
  std::size_t at_ = 0;
  bool binary_ = false;
};

}  // namespace

bool is_vtk_polydata(std::string_view head) {
  return head.starts_with(signature) && head.find("\nDATASET POLYDATA\n") != std::string_view::npos;
}

VtkFile read_vtk(std::string_view content, const std::string& file) {
  return VtkParser(content, file).parse();
}

}  // namespace grainvdb
