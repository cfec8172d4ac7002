#include "read/unsaid.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "read/columns.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

constexpr std::string_view axes = "xyz";

/// "none", or some of x, y, z, each once.
bool names_axes(std::string_view text) {
  if (text == "none") return true;
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char axis) {
    return axes.find(axis) != std::string_view::npos && std::count(text.begin(), text.end(), axis) == 1;
  });
}

[[noreturn]] void refuse_lack(const InputSpec& spec, const std::string& file, const std::string& what,
                              const std::string& expected) {
  throw ConfigError({stated_at(spec, "input"),
                     file + " does not say " + what,
                     {},
                     expected,
                     "If that file is not meant, give the dumps as a pattern instead of a folder"});
}

void name_columns(FrameHeader& header, const InputSpec& spec, const std::string& file) {
  if (spec.columns.empty())
    refuse_lack(spec, file, "what its " + std::to_string(header.columns.size()) + " columns are",
                "input.columns with their names, in the order of the dump command");
  if (spec.columns.size() != header.columns.size())
    throw ConfigError({stated_at(spec, "input.columns"), "input.columns does not fit " + file,
                       std::to_string(spec.columns.size()) + " names", std::to_string(header.columns.size()),
                       "Name all columns, in the order of the dump command"});
  header.columns = spec.columns;
}

}  // namespace

void complete(FrameHeader& header, const InputSpec& spec, const std::string& file) {
  if (header.unsaid.columns) name_columns(header, spec, file);
  if (header.unsaid.periodicity) {
    if (!spec.periodic)
      refuse_lack(spec, file, "which axes are periodic",
                  "input.periodic, or --periodic of info and init: none, or the axes, such as xy");
    for (std::size_t a = 0; a < 3; ++a)
      header.box.periodic[a] = *spec.periodic != "none" && spec.periodic->find(axes[a]) != std::string::npos;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    if (!header.unsaid.bounds[a]) continue;
    if (!spec.box)
      refuse_lack(spec, file, std::string("where the box ends along ") + axes[a],
                  "input.box, or --box of info and init, with the lower and upper corner");
    header.box.lo[a] = spec.box->lo[a];
    header.box.hi[a] = spec.box->hi[a];
  }
  header.unsaid = {};
}

void check_box(const InputSpec& spec) {
  if (spec.periodic && !names_axes(*spec.periodic))
    throw ConfigError({stated_at(spec, "input.periodic"),
                       "input.periodic does not name axes",
                       in_quotes(*spec.periodic),
                       "none, or the axes, such as xy",
                       {}});
  if (!spec.box) return;
  for (std::size_t a = 0; a < 3; ++a)
    if (!(spec.box->lo[a] < spec.box->hi[a]) || !std::isfinite(spec.box->hi[a] - spec.box->lo[a]))
      throw ConfigError({stated_at(spec, "input.box"),
                         std::string("input.box is empty along ") + axes[a],
                         std::to_string(spec.box->lo[a]) + " ... " + std::to_string(spec.box->hi[a]),
                         "lo < hi, both finite",
                         {}});
}

}  // namespace grainvdb
