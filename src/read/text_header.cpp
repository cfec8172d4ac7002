#include "read/text_header.hpp"

#include <array>
#include <cstdint>
#include <limits>

#include "grainvdb/error.hpp"
#include "read/number.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

constexpr std::string_view cut_off_hint = "The file was cut off, or is still being written";

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Whether `text` is `word`, or begins with it and a blank; if so, the word is taken off.
bool take_word(std::string_view& text, std::string_view word) {
  if (!text.starts_with(word) || (text.size() > word.size() && !is_blank(text[word.size()]))) return false;
  text.remove_prefix(word.size());
  return true;
}

}  // namespace

void TextHeaderReader::fail(const std::string& what, const std::string& found, const std::string& expected,
                            const std::string& hint) const {
  throw InputError({{lines_.file(), lines_.line_number()}, what, found, expected, hint});
}

std::optional<FrameHeader> TextHeaderReader::read() {
  header_.start = lines_.position();
  std::string_view name;
  if (!next_section(name)) return std::nullopt;
  do section(name);
  while (!done_ && next_section(name));
  if (!done_)
    fail("the file ends within the header of a frame", {}, "ITEM: ATOMS or ITEM: ENTRIES", std::string(cut_off_hint));
  return std::move(header_);
}

/// False at the end of the file.
bool TextHeaderReader::next_section(std::string_view& name) {
  std::string_view line;
  if (!lines_.next(line)) return false;
  if (!line.starts_with(item_mark))
    fail("a line that belongs to no section", in_quotes(line), "a line that begins with 'ITEM:'");
  if (!lines_.complete())
    fail("the file ends within the header of a frame", in_quotes(line), {}, std::string(cut_off_hint));
  name = trimmed(line.substr(item_mark.size()));
  return true;
}

void TextHeaderReader::section(std::string_view name) {
  std::string_view rest = name;
  if (name == "UNITS") {
    once(has_units_, name);
    read_units();
  } else if (name == "TIME") {
    once(has_time_, name);
    read_time();
  } else if (name == "TIMESTEP") {
    once(has_step_, name);
    read_step();
  } else if (take_word(rest, "NUMBER OF")) {
    once(has_count_, "NUMBER OF");
    read_count(trimmed(rest));
  } else if (take_word(rest, "BOX BOUNDS")) {
    once(has_box_, "BOX BOUNDS");
    read_box(rest);
  } else if ((has_count_ && take_word(rest, label_)) || take_word(rest, "ATOMS") || take_word(rest, "ENTRIES")) {
    const std::string label(name.substr(0, name.size() - rest.size()));
    const auto require = [&](bool seen, std::string_view missing) {
      if (!seen)
        fail("the frame has no 'ITEM: " + std::string(missing) + "'", in_quotes("ITEM: " + label),
             "'ITEM: " + std::string(missing) + "' before it");
    };
    require(has_step_, "TIMESTEP");
    require(has_count_, "NUMBER OF " + label);
    require(has_box_, "BOX BOUNDS");
    if (label != label_)
      fail("the rows are not what was counted", in_quotes("ITEM: " + label),
           "'ITEM: " + label_ + "', as the count was of " + label_);
    read_columns(rest);
    done_ = true;
  } else {
    fail("an unknown section", in_quotes("ITEM: " + std::string(name)),
         "ITEM: UNITS, TIME, TIMESTEP, NUMBER OF, BOX BOUNDS, ATOMS or ENTRIES");
  }
}

/// Marks a section as seen; each may come once in a frame.
void TextHeaderReader::once(bool& seen, std::string_view item) {
  if (seen)
    fail("a second 'ITEM: " + std::string(item) + "' in one frame", {}, "ITEM: ATOMS or ITEM: ENTRIES first",
         "Rows may be missing before this line");
  seen = true;
}

std::string_view TextHeaderReader::value_line(std::string_view item) {
  std::string_view line;
  if (!lines_.next(line) || !lines_.complete())
    fail("the file ends within the header of a frame", {}, "the value of ITEM: " + std::string(item),
         std::string(cut_off_hint));
  return trimmed(line);
}

std::string_view TextHeaderReader::single_value(std::string_view item) {
  std::string_view line = value_line(item);
  const std::string_view whole = line, token = take_token(line);
  if (token.empty() || !line.empty())
    fail("ITEM: " + std::string(item) + " has no single value", in_quotes(whole), "one value");
  return token;
}

void TextHeaderReader::read_units() {
  header_.units = std::string(single_value("UNITS"));
  header_.units_line = lines_.line_number();
}

void TextHeaderReader::read_time() {
  const std::string_view token = single_value("TIME");
  double time = 0;
  if (!parse_real(token, time)) fail("the time is not a finite number", in_quotes(token), "a finite decimal number");
  header_.time = time;
}

void TextHeaderReader::read_step() {
  const std::string_view token = single_value("TIMESTEP");
  if (!parse_whole(token, header_.step) || header_.step < 0)
    fail("the timestep is not a whole number", in_quotes(token), "a whole number, 0 or more");
}

void TextHeaderReader::read_count(std::string_view label) {
  if (label.empty()) fail("ITEM: NUMBER OF does not say of what", {}, "NUMBER OF ATOMS or NUMBER OF ENTRIES");
  // Later messages repeat the label, so that it has to be a text that one can read.
  if (!is_name(label))
    fail("a label of rows that cannot be meant", in_quotes(label), "ATOMS, ENTRIES or another short text");
  label_ = label;
  header_.kind = label_ == "ATOMS" ? RowKind::particles : RowKind::contacts;
  const std::string_view token = single_value("NUMBER OF " + label_);
  std::int64_t count = 0;
  if (!parse_whole(token, count) || count < 0)
    fail("the number of " + label_ + " is not a whole number", in_quotes(token), "a whole number, 0 or more");
  header_.rows = static_cast<std::size_t>(count);
}

void TextHeaderReader::read_box(std::string_view text) {
  const std::string all(trimmed(text));
  if (take_word(text = trimmed(text), "abc"))
    fail("the box is general triclinic", in_quotes("ITEM: BOX BOUNDS " + all), "an orthogonal box",
         "Fields are gridded in orthogonal boxes only");
  const bool tilted = take_word(text, "xy xz yz");
  constexpr std::string_view letters = "'ITEM: BOX BOUNDS' with two boundary letters per axis, such as pp pp ff";
  if (trimmed(text).empty())
    fail("the box does not say which axes are periodic", in_quotes("ITEM: BOX BOUNDS " + all), std::string(letters),
         "Old versions of LAMMPS left the letters out: add them to the dump");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view pair = take_token(text);
    constexpr std::string_view known = "pfsm";
    if (pair.size() != 2 || known.find(pair[0]) == std::string_view::npos ||
        known.find(pair[1]) == std::string_view::npos)
      fail("the boundary letters are not understood", in_quotes("ITEM: BOX BOUNDS " + all), std::string(letters));
    if ((pair[0] == 'p') != (pair[1] == 'p'))
      fail("an axis is periodic on one side only", in_quotes(pair), "pp, or two letters of f, s, m");
    header_.box.periodic[axis] = pair == "pp";
  }
  if (!trimmed(text).empty())
    fail("the boundary letters are not understood", in_quotes("ITEM: BOX BOUNDS " + all), std::string(letters));
  for (std::size_t axis = 0; axis < 3; ++axis) read_bounds(axis, tilted);
}

void TextHeaderReader::read_bounds(std::size_t axis, bool tilted) {
  constexpr std::string_view axes = "xyz";
  const std::string name(1, axes[axis]);
  const std::string_view line = value_line("BOX BOUNDS");
  std::string_view rest = line;
  std::array<double, 3> value{};
  for (std::size_t i = 0; i < (tilted ? 3U : 2U); ++i)
    if (!parse_real(take_token(rest), value[i]))
      fail("the bounds of the box along " + name + " are not numbers", in_quotes(line),
           tilted ? "lo, hi and tilt, finite" : "lo and hi, finite");
  if (!trimmed(rest).empty())
    fail("too many values for the box along " + name, in_quotes(line), tilted ? "lo, hi and tilt" : "lo and hi",
         tilted ? "" : "A tilted box has 'xy xz yz' in its ITEM line");
  if (value[2] != 0)
    fail("the box is tilted (triclinic)", "tilt " + in_quotes(line), "an orthogonal box (all tilts 0)",
         "Fields are gridded in orthogonal boxes only");
  if (!(value[0] < value[1])) fail("the box is empty along " + name, in_quotes(line), "lo < hi");
  if (value[1] - value[0] > std::numeric_limits<double>::max())
    fail("the box is too long along " + name, in_quotes(line), "a length that is a finite number");
  header_.box.lo[axis] = value[0];
  header_.box.hi[axis] = value[1];
}

void TextHeaderReader::read_columns(std::string_view text) {
  for (std::string_view token = take_token(text); !token.empty(); token = take_token(text)) {
    if (!is_name(token))
      fail("a column name that cannot be meant", in_quotes(token), "at most 200 printable characters");
    header_.columns.emplace_back(token);
  }
  header_.columns_line = lines_.line_number();
  if (header_.columns.empty())
    fail("the columns have no names", in_quotes("ITEM: " + label_),
         "'ITEM: " + label_ + "' followed by the names of the columns");
}

}  // namespace grainvdb
