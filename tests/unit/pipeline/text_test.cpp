#include "pipeline/text.hpp"

#include <gtest/gtest.h>

namespace grainvdb::text_test {
namespace {

const std::vector<std::string> fields{"phi", "velocity", "velocity_gradient", "temperature", "mu", "kinetic_stress"};

TEST(DidYouMean, FindsTheNearestName) {
  EXPECT_EQ(nearest("velocty", fields), "velocity");         // a letter left out
  EXPECT_EQ(nearest("velocitty", fields), "velocity");       // one too many
  EXPECT_EQ(nearest("temperatrue", fields), "temperature");  // two swapped
  EXPECT_EQ(nearest("ph1", fields), "phi");
  EXPECT_EQ(nearest("kinetic-stress", fields), "kinetic_stress");
  EXPECT_EQ(nearest("Temperature", fields), "temperature");
}

TEST(DidYouMean, CompletesABeginningThatIsUnique) {
  EXPECT_EQ(nearest("temp", fields), "temperature");
  EXPECT_EQ(nearest("velo", {"velocity", "velocity_gradient"}), "");  // two names begin so
}

TEST(DidYouMean, IsSilentWhenNothingIsNear) {
  EXPECT_EQ(nearest("frobnicate", fields), "");
  EXPECT_EQ(nearest("", fields), "");
  EXPECT_EQ(nearest("x", {"y"}), "");  // every letter would change
  EXPECT_EQ(did_you_mean("frobnicate", fields), "");
  EXPECT_EQ(nearest(std::string(100'000, 'a'), fields), "");
}

TEST(QuoteText, CutsAtACharacterAndEscapesControls) {
  EXPECT_EQ(quote_text("a b"), "'a b'");
  EXPECT_EQ(quote_text("a\n\x1b"), "'a\\x0a\\x1b'");
  std::string umlauts;  // of two bytes each
  for (int i = 0; i < 60; ++i) umlauts += "\xc3\xa4";
  const std::string first_forty = umlauts.substr(0, 80);
  EXPECT_EQ(quote_text(umlauts), std::string("'").append(first_forty).append("…'"));
  // Byte 80 lies inside a letter.
  EXPECT_EQ(quote_text(std::string("x").append(umlauts)), std::string("'x").append(first_forty).append("…'"));
}

TEST(JoinChoices, ReadsAsASentence) {
  EXPECT_EQ(join_choices({}), "");
  EXPECT_EQ(join_choices({"a"}), "a");
  EXPECT_EQ(join_choices({"a", "b", "c"}), "a, b or c");
}

}  // namespace
}  // namespace grainvdb::text_test
