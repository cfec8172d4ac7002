#pragma once
/// Words for error messages: quoting what was found and suggesting what was meant.
#include <string>
#include <string_view>
#include <vector>

namespace grainvdb {

/// The text in single quotes, cut to a readable length, control characters escaped.
std::string quote_text(std::string_view text);

/// The text in double quotes, as YAML reads any text.
std::string yaml_text(const std::string& text);

/// "a, b or c", each in plain text.
std::string join_choices(const std::vector<std::string>& choices);

/// The candidate that `word` most likely stands for: the fewest edits (insertion, deletion, replacement, swap of
/// neighbours, case and '-' for '_' ignored), at most a third of its length; or the only one it is a prefix of. The
/// first of equals; empty when nothing is near.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// "Did you mean 'x'?", or nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace grainvdb
