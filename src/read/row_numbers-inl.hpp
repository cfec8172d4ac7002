// Numbers in vectors, compiled once for every instruction set: include it from files that hwy/foreach_target.h compiles
// again and again, after hwy/highway.h.
#if defined(GRAINVDB_READ_ROW_NUMBERS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_READ_ROW_NUMBERS_INL_HPP
#undef GRAINVDB_READ_ROW_NUMBERS_INL_HPP
#else
#define GRAINVDB_READ_ROW_NUMBERS_INL_HPP
#endif

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

// Without vectors of known size, numbers are left to parse_real and parse_whole.

inline std::size_t all_rows(std::size_t rows, std::uint32_t* left) {
  std::iota(left, left + rows, std::uint32_t{0});
  return rows;
}

inline std::size_t ConvertReals(const char*, const std::uint32_t*, std::size_t, std::size_t rows, double*,
                                std::uint32_t* left) {
  return all_rows(rows, left);
}

inline std::size_t ConvertWholes(const char*, const std::uint32_t*, std::size_t, std::size_t rows, std::int64_t*,
                                 std::uint32_t* left) {
  return all_rows(rows, left);
}

#else

// One number per 64-bit lane. Its characters fill two vectors: `lo` has its sign, or what stands before it, in the
// lowest byte and then seven characters, `hi` has the next eight.
using D = hn::CappedTag<std::uint64_t, 8>;
using DBytes = hn::Repartition<std::uint8_t, D>;
using D16 = hn::Repartition<std::uint16_t, D>;
using D32 = hn::Repartition<std::uint32_t, D>;
using DSigned = hn::RebindToSigned<D>;
using DReal = hn::RebindToFloat<D>;
constexpr D d;
constexpr DBytes d8;
constexpr D16 d16;
constexpr D32 d32;
constexpr DSigned di;
constexpr DReal df;
using V = hn::Vec<D>;
using VReal = hn::Vec<DReal>;
constexpr std::size_t lanes = hn::MaxLanes(D());

struct Pair {
  V lo, hi;
};

HWY_INLINE V set(std::uint64_t value) {
  return hn::Set(d, value);
}
HWY_INLINE V every_byte(std::uint8_t value) {
  return hn::BitCast(d, hn::Set(d8, value));
}
HWY_INLINE V bytes_equal(V a, std::uint8_t value) {
  return hn::BitCast(d, hn::VecFromMask(d8, hn::Eq(hn::BitCast(d8, a), hn::Set(d8, value))));
}
HWY_INLINE V bytes_below(V a, std::uint8_t value) {
  return hn::BitCast(d, hn::VecFromMask(d8, hn::Lt(hn::BitCast(d8, a), hn::Set(d8, value))));
}
HWY_INLINE V digit_bytes(V a) {
  return bytes_below(hn::BitCast(d, hn::Sub(hn::BitCast(d8, a), hn::Set(d8, '0'))), 10);
}
HWY_INLINE hn::Mask<D> is_zero(V a) {
  return hn::Eq(a, hn::Zero(d));
}

/// The bits below the lowest one in 128 bits, whose bytes are 0 or 0xff.
HWY_INLINE Pair below_first(V lo, V hi) {
  const V one = set(1);
  return {hn::AndNot(lo, hn::Sub(lo, one)), hn::IfThenElseZero(is_zero(lo), hn::AndNot(hi, hn::Sub(hi, one)))};
}

/// How many bytes of a pair are 0xff.
HWY_INLINE V count_bytes(Pair marks) {
  const auto minus_lo = hn::Sub(hn::Zero(d8), hn::BitCast(d8, marks.lo));
  return hn::BitCast(d, hn::SumsOf8(hn::Sub(minus_lo, hn::BitCast(d8, marks.hi))));
}

/// Eight digits, the first the most significant, as a number. A product puts 10 a + b, then 100 a + b, into the upper
/// half of what a and b share.
HWY_INLINE V eight_digits(V digits) {
  const auto two = hn::ShiftRight<8>(hn::Mul(hn::BitCast(d16, digits), hn::Set(d16, 10 * 0x100 + 1)));
  const auto four = hn::ShiftRight<16>(hn::Mul(hn::BitCast(d32, two), hn::Set(d32, 100 * 0x10000 + 1)));
  return hn::Add(hn::MulEven(four, hn::Set(d32, 10000)), hn::ShiftRight<32>(hn::BitCast(d, four)));
}

HWY_ALIGN constexpr std::array<double, 23> powers{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

HWY_INLINE VReal power_of_ten(V exponent) {
  return hn::GatherIndex(df, powers.data(), hn::BitCast(di, exponent));
}

/// The same for exponents below 16.
HWY_INLINE VReal small_power_of_ten(V exponent) {
#if HWY_MAX_BYTES == 64
  const auto index = hn::IndicesFromVec(df, hn::And(exponent, set(7)));
  const VReal low = hn::TableLookupLanes(hn::Load(df, powers.data()), index),
              high = hn::TableLookupLanes(hn::Load(df, powers.data() + 8), index);
  return hn::IfThenElse(hn::RebindMask(df, is_zero(hn::And(exponent, set(8)))), low, high);
#else
  return power_of_ten(exponent);
#endif
}

HWY_INLINE Pair load(const char* text, const std::uint32_t* starts, std::size_t stride) {
  constexpr hn::FixedTag<std::uint8_t, 16> sixteen;
  constexpr hn::FixedTag<std::uint64_t, 2> two;
  const auto both = [&](std::size_t i) HWY_ATTR {
    const auto at = [&](std::size_t k) HWY_ATTR {
      const char* const token = text + starts[k * stride];
      const char* const from = token - (*token < '.' ? 0 : 1);
      return hn::BitCast(two, hn::LoadU(sixteen, reinterpret_cast<const std::uint8_t*>(from)));
    };
    const auto a = at(i), b = at(i + 1);
    return std::pair(hn::InterleaveLower(two, a, b), hn::InterleaveUpper(two, a, b));
  };
  const auto [lo0, hi0] = both(0);
#if HWY_MAX_BYTES == 16
  return {lo0, hi0};
#else
  constexpr hn::FixedTag<std::uint64_t, 4> four;
  const auto [lo2, hi2] = both(2);
  const auto low_lo = hn::Combine(four, lo2, lo0), low_hi = hn::Combine(four, hi2, hi0);
#if HWY_MAX_BYTES == 32
  return {low_lo, low_hi};
#else
  const auto [lo4, hi4] = both(4);
  const auto [lo6, hi6] = both(6);
  return {hn::Combine(d, hn::Combine(four, lo6, lo4), low_lo), hn::Combine(d, hn::Combine(four, hi6, hi4), low_hi)};
#endif
#endif
}

/// A token taken apart. Masks have whole bytes, those of characters.
struct Token {
  Pair character;
  V minus;          ///< all ones where the number is negative
  Pair digit;       ///< digits; the lowest byte too
  Pair whole_part;  ///< below the first character that is neither
  Pair point;       ///< that character
  Pair inside;      ///< below the first blank
  V wrong;          ///< non-zero where there is no blank, or neither a sign nor a blank at first
};

HWY_INLINE Token take_apart(Pair character) {
  Token t;
  t.character = character;
  const V lowest = set(0xff), first = hn::And(character.lo, lowest);
  const auto minus = hn::Eq(first, set('-'));
  t.minus = hn::VecFromMask(d, minus);

  t.digit = {hn::Or(digit_bytes(character.lo), lowest), digit_bytes(character.hi)};
  const V ones = set(~std::uint64_t{0});
  const V other_lo = hn::Xor(t.digit.lo, ones), other_hi = hn::Xor(t.digit.hi, ones);
  t.whole_part = below_first(other_lo, other_hi);
  // The byte above the ones: (m + 1) 0xff where m is 2^(8k) - 1.
  const auto byte_above = [&](V m, V other) HWY_ATTR {
    const V bit = hn::And(hn::Add(m, set(1)), other);
    return hn::Sub(hn::ShiftLeft<8>(bit), bit);
  };
  t.point = {byte_above(t.whole_part.lo, other_lo),
             hn::IfThenElseZero(is_zero(other_lo), byte_above(t.whole_part.hi, other_hi))};

  const V blank_first = bytes_below(character.lo, ' ' + 1), blank_lo = hn::AndNot(lowest, blank_first),
          blank_hi = bytes_below(character.hi, ' ' + 1);
  t.inside = below_first(blank_lo, blank_hi);
  const auto lawful = hn::Or(hn::Or(minus, hn::Eq(first, set('+'))), hn::Eq(hn::And(blank_first, lowest), lowest));
  const auto unended = is_zero(hn::Or(blank_lo, blank_hi));
  t.wrong = hn::Or(hn::IfThenZeroElse(lawful, ones), hn::VecFromMask(d, unended));
  return t;
}

/// The digits of `inside` as a number of sixteen: a zero for the lowest byte, then they, then zeros.
struct Digits {
  V value;
  V has_point;  ///< non-zero where a point is among them
  V wrong;      ///< non-zero where they are not digits with at most one point
};

HWY_INLINE Digits digits_of(const Token& t, Pair inside) {
  const V zeros = every_byte('0'), points = every_byte('.');
  const V other_lo = hn::AndNot(t.digit.lo, inside.lo), other_hi = hn::AndNot(t.digit.hi, inside.hi);
  Digits result;
  result.has_point = hn::Or(other_lo, other_hi);
  const V lowest = set(0xff);
  const auto no_digit =
      is_zero(hn::Or(hn::AndNot(lowest, hn::And(t.digit.lo, inside.lo)), hn::And(t.digit.hi, inside.hi)));
  const V no_point =
      hn::Or(hn::And(hn::Xor(t.character.lo, points), other_lo), hn::And(hn::Xor(t.character.hi, points), other_hi));
  const V second = hn::Or(hn::AndNot(t.point.lo, other_lo), hn::AndNot(t.point.hi, other_hi));
  result.wrong = hn::Or(hn::Or(no_point, second), hn::VecFromMask(d, no_digit));

  // A digit is its character with the bits of '0' taken off. Those behind the point move up by one.
  const V lo = hn::And(hn::AndNot(zeros, t.character.lo), hn::AndNot(lowest, inside.lo)),
          hi = hn::And(hn::AndNot(zeros, t.character.hi), inside.hi);
  const V behind_lo = hn::AndNot(hn::Or(t.whole_part.lo, t.point.lo), lo),
          behind_hi = hn::AndNot(hn::Or(t.whole_part.hi, t.point.hi), hi);
  const V all_lo =
              hn::Or(hn::And(lo, t.whole_part.lo), hn::Or(hn::ShiftRight<8>(behind_lo), hn::ShiftLeft<56>(behind_hi))),
          all_hi = hn::Or(hn::And(hi, t.whole_part.hi), hn::ShiftRight<8>(behind_hi));
  const V high = eight_digits(all_lo), low = eight_digits(all_hi);
  result.value = hn::Add(hn::MulEven(hn::BitCast(d32, high), hn::BitCast(d32, set(100000000))), low);
  return result;
}

HWY_INLINE VReal to_real(V below_2_53) {
  return hn::ConvertTo(df, hn::BitCast(di, below_2_53));
}

struct Numbers {
  VReal value;
  V wrong;  ///< non-zero where the token is left to others
};

/// Those with an exponent of two digits, as printf writes it.
HWY_INLINE Numbers with_exponents(const Token& t) {
  const V case_bit = every_byte(0x20);
  const V e_lo = hn::And(bytes_equal(hn::Or(t.character.lo, case_bit), 'e'), t.inside.lo),
          e_hi = hn::And(bytes_equal(hn::Or(t.character.hi, case_bit), 'e'), t.inside.hi);
  const Pair before = below_first(e_lo, e_hi);
  const Pair mantissa{hn::And(before.lo, t.inside.lo), hn::And(before.hi, t.inside.hi)};
  const V length = count_bytes(mantissa);
  V wrong =
      hn::Or(hn::VecFromMask(d, is_zero(hn::Or(e_lo, e_hi))), hn::Xor(hn::Sub(count_bytes(t.inside), length), set(4)));

  // The three characters behind the e.
  const V bits = hn::ShiftLeft<3>(hn::Add(length, set(1))), shift = hn::And(bits, set(63));
  const V across =
      hn::Or(hn::Shr(t.character.lo, shift), hn::Shl(t.character.hi, hn::And(hn::Sub(set(64), shift), set(63))));
  const V behind = hn::IfThenElse(hn::Eq(hn::And(bits, set(64)), hn::Zero(d)), across, hn::Shr(t.character.hi, shift));
  const V sign = hn::And(behind, set(0xff));
  const auto negative = hn::Eq(sign, set('-'));
  const V no_sign = hn::AndNot(hn::VecFromMask(d, hn::Or(negative, hn::Eq(sign, set('+')))), set(1));
  const V tens = hn::Sub(hn::And(hn::ShiftRight<8>(behind), set(0xff)), set('0')),
          units = hn::Sub(hn::And(hn::ShiftRight<16>(behind), set(0xff)), set('0'));
  const V not_digits = hn::Or(hn::VecFromMask(d, hn::Gt(tens, set(9))), hn::VecFromMask(d, hn::Gt(units, set(9))));
  wrong = hn::Or(wrong, hn::Or(no_sign, not_digits));
  const V size = hn::Add(hn::Add(hn::ShiftLeft<3>(tens), hn::ShiftLeft<1>(tens)), units);
  const V exponent = hn::IfThenElse(negative, hn::Sub(hn::Zero(d), size), size);

  // value 10^-zeros is the whole number that the digits spell, exact like its factors.
  const Digits digits = digits_of(t, mantissa);
  const V one_for_point = hn::IfThenZeroElse(hn::Eq(digits.has_point, hn::Zero(d)), set(1));
  const V zeros = hn::And(hn::Add(hn::Sub(set(16), length), one_for_point), set(15));
  const VReal whole = hn::Div(to_real(digits.value), small_power_of_ten(zeros));
  const V power = hn::Add(hn::Add(hn::Sub(count_bytes(t.whole_part), set(16)), zeros), exponent);
  const auto down = hn::Lt(hn::BitCast(di, power), hn::Zero(di));
  const V magnitude = hn::IfThenElse(hn::RebindMask(d, down), hn::Sub(hn::Zero(d), power), power);
  const V out_of_range = hn::VecFromMask(d, hn::Gt(magnitude, set(22)));
  const VReal factor = power_of_ten(hn::Min(magnitude, set(22)));
  const VReal value = hn::IfThenElse(hn::RebindMask(df, down), hn::Div(whole, factor), hn::Mul(whole, factor));
  return {value, hn::Or(hn::Or(wrong, out_of_range), digits.wrong)};
}

HWY_INLINE V plain_scale(const Token& t) {
  return hn::And(hn::Sub(set(16), count_bytes(t.whole_part)), set(15));
}

struct RealColumn {
  using Value = double;
  static HWY_INLINE hn::Mask<D> convert(Pair characters, double* out) {
    const Token t = take_apart(characters);
    const Digits digits = digits_of(t, t.inside);
    VReal value = hn::Div(to_real(digits.value), small_power_of_ten(plain_scale(t)));
    V wrong = digits.wrong;
    if (HWY_UNLIKELY(!hn::AllTrue(d, hn::Eq(wrong, hn::Zero(d))))) {
      const Numbers others = with_exponents(t);
      const auto plain = hn::Eq(wrong, hn::Zero(d));
      value = hn::IfThenElse(hn::RebindMask(df, plain), value, others.value);
      wrong = hn::IfThenElseZero(hn::Not(plain), others.wrong);
    }
    value = hn::Or(value, hn::BitCast(df, hn::And(t.minus, set(std::uint64_t{1} << 63))));
    hn::StoreU(value, df, out);
    return hn::Eq(hn::Or(wrong, t.wrong), hn::Zero(d));
  }
};

struct Wholes {
  V size;
  V minus;  ///< all ones where negative
  V wrong;  ///< non-zero where the token is left to others
};

/// Those of which `blank`, the blanks in the lower half, has one: up to seven characters behind the sign.
HWY_INLINE Wholes short_wholes(V characters, V blank) {
  const V lowest = set(0xff), first = hn::And(characters, lowest);
  const auto minus = hn::Eq(first, set('-'));
  const V inside = hn::AndNot(blank, hn::Sub(blank, set(1))), places = hn::AndNot(lowest, inside);
  const V other = hn::AndNot(digit_bytes(characters), places);
  const auto lawful =
      hn::Or(hn::Or(minus, hn::Eq(first, set('+'))), hn::Eq(hn::And(bytes_below(characters, ' ' + 1), lowest), lowest));
  const V none = hn::VecFromMask(d, is_zero(places));
  const V digits = hn::And(hn::AndNot(every_byte('0'), characters), places);
  const V length = count_bytes({inside, hn::Zero(d)});
  return {eight_digits(hn::Shl(digits, hn::Sub(set(64), hn::ShiftLeft<3>(length)))), hn::VecFromMask(d, minus),
          hn::Or(hn::Or(other, none), hn::IfThenZeroElse(lawful, lowest))};
}

HWY_INLINE Wholes long_wholes(Pair characters) {
  const Token t = take_apart(characters);
  const Digits digits = digits_of(t, t.inside);
  const VReal size = hn::Div(to_real(digits.value), small_power_of_ten(plain_scale(t)));
  return {hn::BitCast(d, hn::ConvertTo(di, size)), t.minus, hn::Or(hn::Or(digits.wrong, digits.has_point), t.wrong)};
}

struct WholeColumn {
  using Value = std::int64_t;
  static HWY_INLINE hn::Mask<D> convert(Pair characters, std::int64_t* out) {
    const V blank = hn::AndNot(set(0xff), bytes_below(characters.lo, ' ' + 1));
    const Wholes wholes =
        HWY_LIKELY(hn::AllFalse(d, is_zero(blank))) ? short_wholes(characters.lo, blank) : long_wholes(characters);
    hn::StoreU(hn::BitCast(di, hn::Sub(hn::Xor(wholes.size, wholes.minus), wholes.minus)), di, out);
    return is_zero(wholes.wrong);
  }
};

template <class Column>
HWY_INLINE std::size_t convert_column(const char* text, const std::uint32_t* starts, std::size_t stride,
                                      std::size_t rows, typename Column::Value* values, std::uint32_t* left) {
  std::uint32_t* next = left;
  const auto note = [&](std::size_t row, hn::Mask<D> taken, std::size_t n) HWY_ATTR {
    if (HWY_LIKELY(hn::AllTrue(d, taken))) return;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, taken, bits);
    for (std::size_t i = 0; i < n; ++i)
      if ((bits[0] >> i & 1) == 0) *next++ = static_cast<std::uint32_t>(row + i);
  };
  std::size_t row = 0;
  for (; row + lanes <= rows; row += lanes)
    note(row, Column::convert(load(text, starts + row * stride, stride), values + row), lanes);
  if (row < rows) {
    const std::size_t n = rows - row;
    std::uint32_t last_starts[lanes];
    typename Column::Value last_values[lanes];
    for (std::size_t i = 0; i < lanes; ++i) last_starts[i] = starts[(row + (i < n ? i : 0)) * stride];
    note(row, Column::convert(load(text, last_starts, 1), last_values), n);
    for (std::size_t i = 0; i < n; ++i) values[row + i] = last_values[i];
  }
  return static_cast<std::size_t>(next - left);
}

HWY_NOINLINE std::size_t ConvertReals(const char* text, const std::uint32_t* starts, std::size_t stride,
                                      std::size_t rows, double* values, std::uint32_t* left) {
  return convert_column<RealColumn>(text, starts, stride, rows, values, left);
}

HWY_NOINLINE std::size_t ConvertWholes(const char* text, const std::uint32_t* starts, std::size_t stride,
                                       std::size_t rows, std::int64_t* values, std::uint32_t* left) {
  return convert_column<WholeColumn>(text, starts, stride, rows, values, left);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();
#endif
