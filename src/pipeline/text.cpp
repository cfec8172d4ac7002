#include "pipeline/text.hpp"

#include <algorithm>
#include <cctype>
#include <limits>

namespace grainvdb {
namespace {

std::string folded(std::string_view word) {
  std::string result(word);
  for (char& c : result) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

// Optimal string alignment distance, with rows of the previous two letters.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string quote_text(std::string_view text) {
  constexpr std::size_t longest = 80;
  static constexpr char hex[] = "0123456789abcdef";
  std::string result = "'";
  std::size_t i = 0;
  for (; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool begins_character = (byte & 0xC0U) != 0x80U;  // never cut inside a UTF-8 sequence
    if (i >= longest && begins_character) break;
    if (byte < 0x20 || byte == 0x7F) {
      result += "\\x";
      result += hex[byte >> 4];
      result += hex[byte & 15U];
    } else {
      result += text[i];
    }
  }
  if (i < text.size()) result += "…";
  return result + "'";
}

std::string yaml_text(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

std::string join_choices(const std::vector<std::string>& choices) {
  std::string result;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (i > 0) result += i + 1 == choices.size() ? " or " : ", ";
    result += choices[i];
  }
  return result;
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  constexpr std::size_t longest = 100;  // nobody misspells that much; bounds the quadratic cost
  if (word.empty() || word.size() > longest) return {};
  const std::string w = folded(word);
  const std::string* best = nullptr;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(w, folded(candidate));
    const std::size_t allowed = std::max<std::size_t>(1, std::max(w.size(), candidate.size()) / 3);
    if (distance <= allowed && distance < least && distance < candidate.size()) {
      least = distance;
      best = &candidate;
    }
  }
  if (best != nullptr) return *best;
  if (w.size() < 3) return {};
  const auto begins = [&](const std::string& candidate) { return folded(candidate).starts_with(w); };
  const auto it = std::find_if(candidates.begin(), candidates.end(), begins);
  if (it == candidates.end() || std::any_of(std::next(it), candidates.end(), begins)) return {};
  return *it;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string guess = nearest(word, candidates);
  return guess.empty() ? std::string() : "Did you mean " + quote_text(guess) + "?";
}

}  // namespace grainvdb
