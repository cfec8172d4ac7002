#include "pipeline/config_node.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <unordered_map>
#include <utility>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include "pipeline/text.hpp"

namespace grainvdb {
namespace {

// What a tree costs: its nodes and the bytes of its scalars.
struct Cost {
  std::size_t nodes = 0;
  std::size_t bytes = 0;
  Cost& operator+=(const Cost& o) {
    nodes += o.nodes;
    bytes += o.bytes;
    return *this;
  }
};

Cost cost_of(const ConfigNode& node) {
  Cost cost{1, node.text.size()};
  for (const ConfigNode& item : node.items) cost += cost_of(item);
  for (const ConfigEntry& entry : node.entries) {
    cost += cost_of(entry.value);
    cost.bytes += entry.key.size();
  }
  return cost;
}

// Builds the tree from the events of the parser. `fixed` replaces every place where the text has no lines of its own.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string file, const Location* fixed) : file_(std::move(file)), fixed_(fixed) {}

  bool has_document() const { return documents_ > 0; }
  ConfigNode take() { return std::move(root_); }
  Location place(const YAML::Mark& mark) const {
    if (fixed_ != nullptr) return *fixed_;
    return {file_, mark.is_null() ? 0 : static_cast<std::size_t>(mark.line) + 1};
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1)
      throw ConfigError({place(mark), "a second YAML document begins here", {}, "one document", "Remove the '---'."});
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(make(ConfigNode::Kind::null, mark), anchor);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_tag(mark, tag);
    ConfigNode node = make(ConfigNode::Kind::scalar, mark);
    node.text = value;
    node.quoted = tag == "!";
    add(std::move(node), anchor);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto it = anchored_.find(anchor);
    if (it == anchored_.end())
      throw ConfigError({place(mark),
                         "this alias stands inside the value that it refers to",
                         {},
                         {},
                         "A value cannot contain itself."});
    spend(it->second.cost, place(mark));
    attach(it->second.node);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(ConfigNode::Kind::sequence, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(ConfigNode::Kind::mapping, mark, tag, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    ConfigNode node;
    YAML::anchor_t anchor = 0;
    std::optional<std::pair<std::string, Location>> key;  // of a mapping: the key whose value comes next
    std::unordered_map<std::string, Location> seen;
  };
  struct Anchored {
    ConfigNode node;
    Cost cost;
  };

  ConfigNode make(ConfigNode::Kind kind, const YAML::Mark& mark) const {
    ConfigNode node;
    node.kind = kind;
    node.where = place(mark);
    return node;
  }

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (!tag.empty() && tag != "?" && tag != "!")
      throw ConfigError(
          {place(mark), "YAML tags are not used in pipeline files", quote_text(tag), {}, "Remove the tag."});
  }

  void spend(const Cost& cost, const Location& where) {
    spent_ += cost;
    if (spent_.nodes > config_limit::nodes || spent_.bytes > config_limit::text_bytes)
      throw ConfigError({where,
                         "the file is too large once its aliases are expanded",
                         std::to_string(spent_.nodes) + " values, " + std::to_string(spent_.bytes) + " bytes of text",
                         "at most " + std::to_string(config_limit::nodes) + " values and " +
                             std::to_string(config_limit::text_bytes) + " bytes",
                         {}});
  }

  void open(ConfigNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    refuse_tag(mark, tag);
    if (open_.size() >= config_limit::depth)
      throw ConfigError({place(mark),
                         "values are nested too deeply",
                         {},
                         "at most " + std::to_string(config_limit::depth) + " levels",
                         {}});
    spend({1, 0}, place(mark));
    open_.push_back({make(kind, mark), anchor, std::nullopt, {}});
  }

  void close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    keep(done.node, done.anchor);
    attach(std::move(done.node));
  }

  // Scalars and nulls.
  void add(ConfigNode node, YAML::anchor_t anchor) {
    spend({1, node.text.size()}, node.where);
    keep(node, anchor);
    attach(std::move(node));
  }

  void keep(const ConfigNode& node, YAML::anchor_t anchor) {
    if (anchor == 0) return;
    const Cost cost = cost_of(node);
    spend(cost, node.where);
    anchored_.insert_or_assign(anchor, Anchored{node, cost});
  }

  void attach(ConfigNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.kind == ConfigNode::Kind::sequence) {
      parent.node.items.push_back(std::move(node));
    } else if (!parent.key) {
      begin_entry(parent, node);
    } else {
      if (node.kind == ConfigNode::Kind::null)
        node.where = parent.key->second;  // the parser only knows what comes next
      parent.node.entries.push_back({std::move(parent.key->first), parent.key->second, std::move(node)});
      parent.key.reset();
    }
  }

  static void begin_entry(Open& parent, const ConfigNode& key) {
    if (key.kind != ConfigNode::Kind::scalar)
      throw ConfigError({key.where, "a key must be a name", key.kind_name(), {}, {}});
    if (key.text == "<<")
      throw ConfigError({key.where, "merge keys ('<<') are not supported", {}, {}, "Write the keys out."});
    const auto [it, is_new] = parent.seen.emplace(key.text, key.where);
    if (!is_new)
      throw ConfigError(
          {key.where,
           "the key " + quote_text(key.text) + " is repeated",
           {},
           {},
           it->second.line == 0 ? "" : "It stands first in line " + std::to_string(it->second.line) + "."});
    parent.key.emplace(key.text, key.where);
  }

  std::string file_;
  const Location* fixed_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Anchored> anchored_;
  Cost spent_;
  ConfigNode root_;
  int documents_ = 0;
};

// YAML texts are UTF-8 without control characters; the parser would replace or drop the rest silently.
void check_characters(const std::string& text, const std::string& file, const Location* fixed) {
  std::size_t line = 1;
  const auto here = [&] { return fixed != nullptr ? *fixed : Location{file, line}; };
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    std::size_t length = byte < 0x80 ? 1 : byte >= 0xC2 && byte < 0xE0 ? 2 : (byte & 0xF0U) == 0xE0 ? 3 : 0;
    if (byte >= 0xF0 && byte < 0xF5) length = 4;
    bool valid = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; valid && k < length; ++k)
      valid = (static_cast<unsigned char>(text[i + k]) & 0xC0U) == 0x80U;
    if (!valid) throw ConfigError({here(), "this is not UTF-8 text", {}, "YAML text in UTF-8", {}});
    if ((byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7F)
      throw ConfigError(
          {here(), "this text holds a control character", quote_text(text.substr(i, 1)), "YAML text", {}});
    if (byte == '\n') ++line;
    i += length;
  }
}

// Column names such as c_cl[1] are a frequent cause of broken lists.
std::string hint_for_line(const std::string& text, std::size_t line) {
  std::istringstream stream(text);
  std::string words;
  for (std::size_t i = 0; i < line; ++i) std::getline(stream, words);
  const auto is_name = [](char c) { return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t i = 1; i < words.size(); ++i)
    if (words[i] == '[' && is_name(words[i - 1])) return "Names with brackets need quotes inside [] and {}.";
  return {};
}

ConfigNode parse(const std::string& text, const std::string& file, const Location* fixed) {
  check_characters(text, file, fixed);
  std::istringstream stream(text);
  TreeBuilder builder(file, fixed);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& e) {
    const std::size_t line = e.mark.is_null() ? 0 : static_cast<std::size_t>(e.mark.line) + 1;
    throw ConfigError({builder.place(e.mark), "this is not valid YAML: " + e.msg, {}, {}, hint_for_line(text, line)});
  }
  if (!builder.has_document()) return ConfigNode{};
  return builder.take();
}

}  // namespace

ConfigNode* ConfigNode::find(const std::string& key) {
  const auto it = std::find_if(entries.begin(), entries.end(), [&](const ConfigEntry& e) { return e.key == key; });
  return it == entries.end() ? nullptr : &it->value;
}

std::string ConfigNode::kind_name() const {
  switch (kind) {
    case Kind::null:
      return "nothing";
    case Kind::sequence:
      return "a list";
    case Kind::mapping:
      return "a section";
    case Kind::scalar:
      break;
  }
  return quoted ? "the text " + quote_text(text) + " in quotes" : quote_text(text);
}

ConfigNode read_config(const std::string& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream) throw IoError("cannot open the pipeline file", file, errno);
  std::string text(config_limit::file_bytes + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), stream.get()));
  if (std::ferror(stream.get()) != 0) throw IoError("cannot read the pipeline file", file, errno);
  if (text.size() > config_limit::file_bytes)
    throw ConfigError({Location{file},
                       "the file is too large for a pipeline file",
                       {},
                       "at most " + std::to_string(config_limit::file_bytes) + " bytes",
                       {}});
  return parse_config(text, file);
}

ConfigNode parse_config(const std::string& text, const std::string& file) {
  ConfigNode root = parse(text, file, nullptr);
  if (root.kind == ConfigNode::Kind::null)
    throw ConfigError({Location{file}, "the pipeline file is empty", {}, "a file that begins with 'grainvdb: 1'", {}});
  return root;
}

ConfigNode parse_config_value(const std::string& text, const Location& where) {
  ConfigNode node = parse(text, where.file, &where);
  if (node.where.file.empty()) node.where = where;
  return node;
}

}  // namespace grainvdb
