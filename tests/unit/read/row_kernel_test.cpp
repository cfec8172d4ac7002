#define HWY_WANT_AVX3_DL  // as the kernels do
#include "read/row_kernel.hpp"

#include <bit>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "read/number.hpp"
#include "support/random.hpp"
#include "unit/read/dump_files.hpp"

namespace grainvdb::row_kernel_test {
namespace {

using testing::Random;

constexpr std::size_t margin = 64;

/// Tries every instruction set that this machine and this build have.
class RowKernel : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
  bool has_vectors() const { return GetParam() != HWY_SCALAR; }
};

INSTANTIATE_TEST_SUITE_P(Targets, RowKernel, ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& param) { return std::string(hwy::TargetName(param.param)); });

std::string padded(const std::string& text) {
  return std::string(margin, '\n') + text + std::string(margin, 'x');
}

/// Tokens in one column, one per line, through the kernel and through parse.
template <class T, class Convert, class Parse>
std::size_t compare(const std::vector<std::string>& tokens, Convert convert, Parse parse) {
  std::size_t all_left = 0;
  for (std::size_t begin = 0; begin < tokens.size(); begin += 100) {
    const std::size_t n = std::min<std::size_t>(100, tokens.size() - begin);
    std::string text;
    std::vector<std::uint32_t> starts;
    for (std::size_t i = 0; i < n; ++i) {
      starts.push_back(static_cast<std::uint32_t>(text.size()));
      text += tokens[begin + i] + (i % 3 == 0 ? " \n" : i % 3 == 1 ? "\n" : "\t\n");
    }
    const std::string all = padded(text);
    std::vector<T> values(n, T{77});
    std::vector<std::uint32_t> left(n);
    const std::size_t count = convert(all.data() + margin, starts.data(), 1, n, values.data(), left.data());
    EXPECT_TRUE(std::is_sorted(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(count)));
    all_left += count;
    for (std::size_t i = 0, k = 0; i < n; ++i) {
      if (k < count && left[k] == i) {
        ++k;
        continue;
      }
      T expected{};
      const std::string& token = tokens[begin + i];
      EXPECT_TRUE(parse(token, expected)) << "taken, though it is no number: " << token;
      EXPECT_EQ(std::bit_cast<std::uint64_t>(values[i]), std::bit_cast<std::uint64_t>(expected)) << token;
    }
  }
  return all_left;
}

std::size_t compare_reals(const std::vector<std::string>& tokens) {
  return compare<double>(tokens, convert_reals, [](std::string_view t, double& v) { return parse_real(t, v); });
}
std::size_t compare_wholes(const std::vector<std::string>& tokens) {
  return compare<std::int64_t>(tokens, convert_wholes,
                               [](std::string_view t, std::int64_t& v) { return parse_whole(t, v); });
}

double random_double(Random& random) {
  switch (random.below(4)) {
    case 0:
      return random.normal();
    case 1:
      return random.normal() * std::pow(10.0, random.uniform(-25, 25));
    case 2:
      return random.uniform() < 0.5 ? random.uniform(-1e-4, 1e-4) : std::floor(random.uniform(-1e9, 1e9));
    default: {
      const auto bits =
          static_cast<std::uint64_t>(random.below(std::size_t{1} << 32)) << 32 | random.below(std::size_t{1} << 32);
      const auto any = std::bit_cast<double>(bits);
      return std::isfinite(any) ? any : 0.0;
    }
  }
}

TEST_P(RowKernel, AgreesToTheBitOnPrintedNumbers) {
  Random random(1);
  constexpr std::array formats{"%g",  "%.9g", "%.3f", "%.12g", "%.15g", "%.16e", "%.17g",
                               "%+g", "%.0f", "%#g",  "%E",    "%.1e",  "%.20f", "%.8g"};
  std::vector<std::string> tokens;
  for (std::size_t i = 0; i < 400'000; ++i) {
    tokens.push_back(testing_dumps::printed(formats[i % formats.size()], random_double(random)));
    if (tokens.back().size() > 40) tokens.pop_back();
  }
  compare_reals(tokens);
  compare_wholes(tokens);
}

TEST_P(RowKernel, AgreesOnTextThatIsNearlyANumber) {
  Random random(2);
  constexpr std::string_view letters = "0123456789012345678901234567899.+-eE..--x,_nai/:";
  std::vector<std::string> tokens;
  for (std::size_t i = 0; i < 400'000; ++i) {
    std::string token(1 + random.below(i % 2 == 0 ? 7 : 24), ' ');
    for (char& c : token) c = letters[random.below(letters.size())];
    tokens.push_back(token);
  }
  // Numbers with one character replaced, and with bytes that are not ASCII.
  for (std::size_t i = 0; i < 200'000; ++i) {
    std::string token = testing_dumps::printed(i % 2 == 0 ? "%g" : "%.8e", random_double(random));
    auto c = static_cast<char>(random.below(256));
    if (is_blank(c) || static_cast<unsigned char>(c) < 0x20) c = '\x80';
    token[random.below(token.size())] = c;
    if (token.find(' ') == std::string::npos) tokens.push_back(token);
  }
  compare_reals(tokens);
  compare_wholes(tokens);
}

TEST_P(RowKernel, AgreesOnHardCases) {
  std::vector<std::string> tokens{"0",
                                  "-0",
                                  "+0",
                                  "-0.0",
                                  "0e0",
                                  "0e+00",
                                  "-0e-99",
                                  "1.",
                                  ".5",
                                  "-.5",
                                  "+.5",
                                  "+1",
                                  "-1",
                                  "+-1",
                                  "-+1",
                                  "--1",
                                  ".",
                                  "-",
                                  "+",
                                  "-.",
                                  "+.",
                                  "e",
                                  "e5",
                                  ".e5",
                                  "-e5",
                                  "1e",
                                  "1e+",
                                  "1e-",
                                  "1.5e",
                                  "1.5e+",
                                  "1.5e+1",
                                  "1.5e+01",
                                  "1.5e+001",
                                  "1.e+05",
                                  ".1e+05",
                                  "1e05",
                                  "1e5",
                                  "1E+22",
                                  "1e+23",
                                  "1e-22",
                                  "1e-23",
                                  "9e+22",
                                  "1.5e-07e",
                                  "1e+0x",
                                  "1e+1.",
                                  "1.2.3",
                                  "1..2",
                                  "..1",
                                  "inf",
                                  "-inf",
                                  "nan",
                                  "NaN",
                                  "infinity",
                                  "0x10",
                                  "1,5",
                                  "1e400",
                                  "1e-400",
                                  "5e-324",
                                  "2.5e-324",
                                  "4.9406564584124654e-324",
                                  "2.2250738585072011e-308",
                                  "1.7976931348623157e308",
                                  "1.7976931348623159e308",
                                  "9007199254740993",
                                  "9007199254740992",
                                  "9007199254740991",
                                  "999999999999999",
                                  "9999999999999999",
                                  "99999999999999999999",
                                  "0.000000000000001",
                                  "123456789012345",
                                  "12345678901234.5",
                                  "-12345678901234",
                                  "-1234567890123.",
                                  "000000000000001",
                                  "00000000000000001",
                                  "1-2",
                                  "1+2",
                                  "12e+3-",
                                  "1e+05.",
                                  "1e+05e+05",
                                  "e+05",
                                  "-e+05",
                                  ".e+05",
                                  "1.2e+05x",
                                  "1.25e-1",
                                  "1.2e+5 ",
                                  "6.7897e-07",
                                  "9.99999e+22",
                                  "9.99999e-18",
                                  "123456e+22",
                                  "1234567890e+15",
                                  "0.1e+22",
                                  "0.1e+23",
                                  "0.12345678e-14",
                                  "100000000000e+11"};
  for (int e = -40; e <= 40; ++e)
    for (const char* mantissa : {"1", "9", "1.5", "-9.99999", "7.1234567", "0.1", "10.", "0"})
      tokens.push_back(mantissa + testing_dumps::printed("e%+03.0f", e));
  for (std::string& token : tokens)
    while (!token.empty() && token.back() == ' ') token.pop_back();
  compare_reals(tokens);
  compare_wholes(tokens);
}

TEST_P(RowKernel, LeavesNothingThatDumpsUsuallyPrint) {
  if (!has_vectors()) GTEST_SKIP() << "without vectors everything is left";
  Random random(3);
  std::vector<std::string> reals, wholes;
  for (std::size_t i = 0; i < 10'000; ++i) {
    const double value = random.normal() * std::pow(10.0, random.uniform(-12, 12));
    reals.push_back(testing_dumps::printed("%g", value));
    reals.push_back(testing_dumps::printed("%.9g", random.normal()));
    wholes.push_back(std::to_string(random.below(std::size_t{1} << (i % 40))));
    wholes.push_back("-" + wholes.back());
  }
  EXPECT_EQ(compare_reals(reals), 0U);
  EXPECT_EQ(compare_wholes(wholes), 0U);
}

TEST_P(RowKernel, FindsTokensAndLinesLikeALoop) {
  Random random(4);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text;
    const std::size_t size = trial % 10 == 0 ? LineIndex::window : random.below(400);
    constexpr std::array<std::string_view, 3> all_letters{"1234567  \n", "ab\x80\xff \t\r\n\n", "1 "};
    const std::string_view letters = all_letters[static_cast<std::size_t>(trial) % all_letters.size()];
    const bool as_many_as_fit = trial % 51 == 2;
    for (std::size_t i = 0; i < size; ++i) text += letters[as_many_as_fit ? i % 2 : random.below(letters.size())];
    const bool plain = trial % 7 != 0 || text.empty();
    if (!plain) text[random.below(text.size())] = static_cast<char>(trial % 9);
    std::vector<std::uint32_t> starts, newlines;
    bool in_token = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const bool blank = is_blank(text[i]) || text[i] == '\n';
      if (!blank && !in_token) starts.push_back(static_cast<std::uint32_t>(i));
      if (text[i] == '\n') newlines.push_back(static_cast<std::uint32_t>(i));
      in_token = !blank;
    }
    const std::string all = padded(text);
    LineIndex index;
    index_lines(all.data() + margin, text.size(), index);
    ASSERT_EQ(index.plain, plain) << trial;
    if (!plain) continue;
    ASSERT_EQ(std::vector(index.starts.begin(), index.starts.begin() + static_cast<std::ptrdiff_t>(index.tokens)),
              starts);
    ASSERT_EQ(std::vector(index.newlines.begin(), index.newlines.begin() + static_cast<std::ptrdiff_t>(index.lines)),
              newlines);
    EXPECT_GT(index.starts[index.tokens], text.size());
    EXPECT_EQ(count_lines(all.data() + margin, text.size()).lines, newlines.size());
  }
}

TEST_P(RowKernel, CountsLinesAndThoseThatMayBeginASection) {
  Random random(7);
  for (int trial = 0; trial < 500; ++trial) {
    std::string text;
    std::size_t lines = random.below(200), marked = 0;
    for (std::size_t i = 0; i < lines; ++i) {
      const bool mark = random.below(10) == 0;
      marked += mark ? 1 : 0;
      text += mark ? 'I' : 'x';
      text.append(random.below(70), 'I');
      text += '\n';
    }
    const std::string all = padded(text);
    const LineCount count = count_lines(all.data() + margin, text.size());
    ASSERT_EQ(count.lines, lines);
    ASSERT_EQ(count.marked, marked);
  }
}

}  // namespace
}  // namespace grainvdb::row_kernel_test
