#include "grainvdb/error.hpp"

#include <cerrno>
#include <string>

#include <gtest/gtest.h>

namespace grainvdb::error_test {
namespace {

Problem problem(const std::string& what, const std::string& found = {}, const std::string& expected = {},
                const std::string& hint = {}) {
  Problem p;
  p.where.file = "dump.1";
  p.where.line = 12;
  p.what = what;
  p.found = found;
  p.expected = expected;
  p.hint = hint;
  return p;
}

TEST(Error, MessageHasPlaceFaultFoundExpectedAndHint) {
  const InputError e(problem("bad number", "'1.5e'", "a number", "See line 9"));
  EXPECT_STREQ(e.what(), "dump.1:12: bad number; found '1.5e'; expected a number. See line 9");
}

TEST(Error, KeepsItsPartsAlsoInCopies) {
  const Problem given = problem("bad number", "'1.5e'", "a number", "See line 9");
  const Error copy = InputError(given);
  EXPECT_EQ(to_string(copy.problem().where), "dump.1:12");
  EXPECT_EQ(copy.problem().what, given.what);
  EXPECT_EQ(copy.problem().found, given.found);
  EXPECT_EQ(copy.problem().expected, given.expected);
  EXPECT_EQ(copy.problem().hint, given.hint);
}

TEST(Error, EmptyPartsAreLeftOut) {
  EXPECT_STREQ(InputError(problem("bad number")).what(), "dump.1:12: bad number");
  Problem nowhere;
  nowhere.what = "no frames";
  EXPECT_STREQ(InputError(nowhere).what(), "no frames");
}

TEST(Error, WholeFileHasNoLine) {
  EXPECT_EQ(to_string(Location{"a.yaml", 0}), "a.yaml");
  EXPECT_EQ(to_string(Location{"a.yaml", 3}), "a.yaml:3");
}

TEST(Error, EachKindHasItsExitCode) {
  EXPECT_EQ(ConfigError(problem("x")).exit_code(), 1);
  EXPECT_EQ(InputError(problem("x")).exit_code(), 2);
  EXPECT_EQ(IoError("cannot open", "f", ENOENT).exit_code(), 3);
  EXPECT_EQ(LimitError(problem("x")).exit_code(), 4);
}

TEST(Error, IoErrorNamesThePathAndTheReason) {
  EXPECT_STREQ(IoError("cannot open", "/a/b", ENOENT).what(), "/a/b: cannot open (No such file or directory)");
  EXPECT_STREQ(IoError("cannot write", "/a/b", 0, "Free some space").what(), "/a/b: cannot write. Free some space");
}

TEST(Error, AllKindsAreErrors) {
  EXPECT_THROW(throw IoError("cannot open", "f", ENOENT), Error);
  EXPECT_THROW(throw LimitError(problem("x")), std::runtime_error);
}

}  // namespace
}  // namespace grainvdb::error_test
