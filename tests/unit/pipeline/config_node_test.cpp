#include "pipeline/config_node.hpp"

#include <chrono>

#include <gmock/gmock.h>

namespace grainvdb::config_node_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string refusal(const std::string& text) {
  try {
    parse_config(text, "F");
  } catch (const ConfigError& error) {
    return error.what();
  }
  ADD_FAILURE() << "not refused:\n" << text;
  return {};
}

TEST(ConfigNode, KeepsKindsTextsAndLines) {
  ConfigNode root = parse_config("# a comment\na: 1\nb:\n  - x\n  - \"2\"\nc: {d: }\n", "F");
  ASSERT_EQ(root.kind, ConfigNode::Kind::mapping);
  EXPECT_EQ(root.find("a")->text, "1");
  EXPECT_FALSE(root.find("a")->quoted);
  EXPECT_EQ(root.find("a")->where.line, 2U);
  EXPECT_EQ(root.entries[1].where.line, 3U);
  EXPECT_EQ(root.find("b")->items[1].where.line, 5U);
  EXPECT_TRUE(root.find("b")->items[1].quoted);
  EXPECT_EQ(root.find("c")->find("d")->kind, ConfigNode::Kind::null);
  EXPECT_EQ(root.find("e"), nullptr);
}

TEST(ConfigNode, AliasesAreCopies) {
  ConfigNode root = parse_config("a: &x [1, 2]\nb: *x\n", "F");
  ASSERT_EQ(root.find("b")->items.size(), 2U);
  EXPECT_EQ(root.find("b")->items[1].text, "2");
}

TEST(ConfigNode, RefusesRepeatedKeys) {
  EXPECT_THAT(refusal("a: 1\nb: 2\na: 3\n"), StartsWith("F:3: the key 'a' is repeated"));
  EXPECT_THAT(refusal("a: 1\nb: 2\na: 3\n"), HasSubstr("line 1"));
  EXPECT_THAT(refusal("s:\n  x: {k: 1,\n     k: 2}\n"), StartsWith("F:3: the key 'k' is repeated"));
  EXPECT_THAT(refusal("a: 1\n'a': 3\n"), StartsWith("F:2: the key 'a' is repeated"));
}

TEST(ConfigNode, RefusesAliasCycles) {
  EXPECT_THAT(refusal("a: 1\nb: &x [1, *x]\n"),
              StartsWith("F:2: this alias stands inside the value that it refers to"));
  EXPECT_THAT(refusal("b: &x\n  c: {d: *x}\n"), StartsWith("F:2: this alias"));
}

TEST(ConfigNode, RefusesAliasBombs) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string last = "*a" + std::to_string(i - 1), name = "a" + std::to_string(i);
    text += name + ": &" + name + " [" + last;
    for (int k = 1; k < 10; ++k) text += ", " + last;
    text += "]\n";
  }
  EXPECT_THAT(refusal(text), HasSubstr("too large once its aliases are expanded"));
  // The fifth line would bring 10^5 values.
  EXPECT_THAT(refusal(text), testing::MatchesRegex("F:[45]: .*"));
}

TEST(ConfigNode, RefusesLongTextsMultipliedByAliases) {
  std::string text = "a: &a " + std::string(1'000'000, 'x') + "\nb: [*a";
  for (int k = 0; k < 100; ++k) text += ", *a";
  EXPECT_THAT(refusal(text + "]\n"), StartsWith("F:2: the file is too large once its aliases are expanded"));
}

TEST(ConfigNode, RefusesDeepNesting) {
  EXPECT_THAT(refusal("a:\n  " + std::string(40, '[') + std::string(40, ']')),
              StartsWith("F:2: values are nested too deeply"));
  // Far deeper than the stack would bear.
  EXPECT_THAT(refusal(std::string(1'000'000, '[')), HasSubstr("nested too deeply"));
}

TEST(ConfigNode, RefusesWhatPipelineFilesHaveNoUseFor) {
  EXPECT_THAT(refusal("a: 1\n---\nb: 2\n"), StartsWith("F:2: a second YAML document"));
  EXPECT_THAT(refusal("a: &m {b: 1}\nc:\n  <<: *m\n"), StartsWith("F:3: merge keys ('<<') are not supported"));
  EXPECT_THAT(refusal("a: !!float 3\n"), StartsWith("F:1: YAML tags are not used"));
  EXPECT_THAT(refusal("? [1, 2]\n: 3\n"), StartsWith("F:1: a key must be a name; found a list"));
  EXPECT_THAT(refusal(": 3\n"), StartsWith("F:1: a key must be a name; found nothing"));
}

TEST(ConfigNode, RefusesEmptyTexts) {
  for (const char* text : {"", "\n\n", "# only a comment\n", "---\n", "~\n"})
    EXPECT_THAT(refusal(text), StartsWith("F: the pipeline file is empty")) << text;
}

TEST(ConfigNode, TurnsSyntaxErrorsIntoConfigErrors) {
  EXPECT_THAT(refusal("a: 1\nb: [1, 2\n"), testing::MatchesRegex("F:[23]: this is not valid YAML: .*"));
  EXPECT_THAT(refusal("a: 1\n\tb: 2\n"), StartsWith("F:2: this is not valid YAML"));
  EXPECT_THAT(refusal("a: 1\nb: c: d\n"), StartsWith("F:2: this is not valid YAML"));
  EXPECT_THAT(refusal("a: 1\nb: {id: c_cl[7], x: 2}\n"), HasSubstr("Names with brackets need quotes"));
  EXPECT_THAT(refusal("a: *nowhere\n"), StartsWith("F:1: this is not valid YAML"));
}

TEST(ConfigNode, RefusesWhatIsNotText) {
  EXPECT_THAT(refusal("a: 1\nb: \xff\n"), StartsWith("F:2: this is not UTF-8 text"));
  EXPECT_THAT(refusal(std::string("a: 1\nb: \0\n", 10)), StartsWith("F:2: this text holds a control character"));
  EXPECT_THAT(refusal("a: \x1b[31m\n"), StartsWith("F:1: this text holds a control character; found '\\x1b'"));
  EXPECT_EQ(parse_config("name: d\xc3\xbcne\n", "F").find("name")->text, "d\xc3\xbcne");
}

TEST(ConfigNode, FilesThatCannotBeReadAreIoErrors) {
  EXPECT_THROW(read_config("/no/such/file.yaml"), IoError);
  EXPECT_THROW(read_config("/"), IoError);
  EXPECT_THAT([] { read_config("/dev/zero"); },
              testing::ThrowsMessage<ConfigError>(HasSubstr("too large for a pipeline file")));
}

TEST(ConfigNode, ValuesOfTheCommandLineStandWhereTheyWereGiven) {
  const ConfigNode node = parse_config_value("[a, b]", {"--set k=[a, b]", 0});
  EXPECT_EQ(to_string(node.items[1].where), "--set k=[a, b]");
  EXPECT_EQ(to_string(parse_config_value("", {"--set k=", 0}).where), "--set k=");
}

}  // namespace
}  // namespace grainvdb::config_node_test
