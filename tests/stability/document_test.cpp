// docs/stability.md names tests and keys: all of them are there.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "grainvdb/pipeline.hpp"
#include "support/sample_dumps.hpp"

namespace grainvdb::testing::document_test {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// "Suite.Name" of every test in the sources.
std::set<std::string> names_of_tests() {
  const std::regex test(R"(TEST(_P|_F)?\((\w+),\s*(\w+)\))");
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(in_repository("tests"))) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = text_of(entry.path());
    for (std::sregex_iterator it(text.begin(), text.end(), test), end; it != end; ++it)
      names.insert((*it)[2].str() + '.' + (*it)[3].str());
  }
  return names;
}

std::set<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::set<std::string> all;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) all.insert((*it)[1]);
  return all;
}

TEST(StabilityDocument, NamesTestsThatThereAre) {
  const std::set<std::string> known = names_of_tests();
  const std::set<std::string> named =
      matches(text_of(in_repository("docs/stability.md")), std::regex(R"(`([A-Z]\w+\.[A-Z]\w+)`)"));
  EXPECT_GT(named.size(), 60U);
  for (const std::string& name : named) EXPECT_TRUE(known.contains(name)) << name;
}

TEST(StabilityDocument, NamesKeysThatThereAre) {
  const std::set<std::string> named =
      matches(text_of(in_repository("docs/stability.md")), std::regex(R"(`([a-z]+(\.[a-z_]+)+)`)"));
  EXPECT_GT(named.size(), 15U);
  const auto schema = nlohmann::json::parse(pipeline_schema());
  for (const std::string& key : named) {
    std::string place = "/properties/" + key;
    for (std::size_t dot; (dot = place.find('.')) != std::string::npos;) place.replace(dot, 1, "/properties/");
    EXPECT_TRUE(schema.contains(nlohmann::json::json_pointer(place))) << key;
  }
}

}  // namespace
}  // namespace grainvdb::testing::document_test
