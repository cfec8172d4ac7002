#include "read/row_kernel.hpp"

#include <bit>

#include "read/text.hpp"

// Compresses bytes, which takes the places of tokens out of a block at once. Has to come before Highway.
#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "read/row_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "read/row_numbers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One bit per byte of a block of 64: whether it is a blank or a newline, a newline, a control character that is
/// neither.
struct Block {
  std::uint64_t blank = 0, newline = 0, control = 0;
};

#if HWY_TARGET == HWY_SCALAR || HWY_HAVE_SCALABLE

Block classify(const char* text) {
  Block block;
  for (std::size_t i = 0; i < 64; ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    block.blank |= std::uint64_t{c <= ' '} << i;
    block.newline |= std::uint64_t{c == '\n'} << i;
    block.control |= std::uint64_t{c < ' ' && !is_blank(text[i])} << i;
  }
  block.control ^= block.newline;
  return block;
}

std::uint64_t equal_bytes(const char* text, char value) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 64; ++i) bits |= std::uint64_t{text[i] == value} << i;
  return bits;
}

#else

using Text = hn::CappedTag<std::uint8_t, 64>;
constexpr Text text_tag;
using TextVec = hn::Vec<Text>;

template <class Mask>
HWY_INLINE std::uint64_t bits_of(Mask mask) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(text_tag, mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

HWY_INLINE std::uint64_t equal_bytes(const char* text, char value) {
  const TextVec all = hn::Set(text_tag, static_cast<std::uint8_t>(value));
  std::uint64_t bits = 0;
  constexpr std::size_t n = hn::MaxLanes(text_tag);
  for (std::size_t i = 0; i < 64; i += n)
    bits |= bits_of(hn::Eq(hn::LoadU(text_tag, reinterpret_cast<const std::uint8_t*>(text + i)), all)) << i;
  return bits;
}

HWY_INLINE Block classify(const char* text) {
  const TextVec space = hn::Set(text_tag, ' '), above_space = hn::Set(text_tag, ' ' + 1),
                newline = hn::Set(text_tag, '\n');
  Block block;
  constexpr std::size_t n = hn::MaxLanes(text_tag);
  for (std::size_t i = 0; i < 64; i += n) {
    const TextVec c = hn::LoadU(text_tag, reinterpret_cast<const std::uint8_t*>(text + i));
    block.blank |= bits_of(hn::Lt(c, above_space)) << i;
    block.newline |= bits_of(hn::Eq(c, newline)) << i;
    block.control |= bits_of(hn::Lt(c, space)) << i;
  }
  block.control ^= block.newline;
  if (HWY_UNLIKELY(block.control != 0)) block.control &= ~(equal_bytes(text, '\t') | equal_bytes(text, '\r'));
  return block;
}

#endif

/// Writes `at` plus the place of each bit, and anything behind them up to place 32. Returns the end of what counts.
#if HWY_TARGET == HWY_AVX3_DL
HWY_INLINE std::uint32_t* write_places(std::uint64_t bits, std::uint32_t at, std::uint32_t* to) {
  constexpr hn::CappedTag<std::uint32_t, 16> places;
  constexpr hn::FixedTag<std::uint8_t, 16> sixteen;
  constexpr hn::FixedTag<std::uint8_t, 32> half;
  const auto mask = hn::LoadMaskBits(text_tag, reinterpret_cast<const std::uint8_t*>(&bits));
  const auto packed = hn::LowerHalf(half, hn::Compress(hn::Iota(text_tag, 0), mask));
  const auto first = hn::Set(places, at);
  const int count = std::popcount(bits);
  hn::StoreU(hn::Add(first, hn::PromoteTo(places, hn::LowerHalf(sixteen, packed))), places, to);
  if (HWY_UNLIKELY(count > 16))
    hn::StoreU(hn::Add(first, hn::PromoteTo(places, hn::UpperHalf(sixteen, packed))), places, to + 16);
  return to + count;
}
#else
HWY_INLINE std::uint32_t* write_places(std::uint64_t bits, std::uint32_t at, std::uint32_t* to) {
  // Writing a fixed number of places, used or not, spares a branch that cannot be foreseen.
  std::uint32_t* const end = to + std::popcount(bits);
  for (int k = 0; k < 10; ++k, bits &= bits - 1) to[k] = at + static_cast<std::uint32_t>(std::countr_zero(bits));
  for (to += 10; bits != 0; bits &= bits - 1) *to++ = at + static_cast<std::uint32_t>(std::countr_zero(bits));
  return end;
}
#endif

void IndexLines(const char* text, std::size_t size, LineIndex& index) {
  std::uint32_t* token = index.starts.data();
  std::uint32_t* line = index.newlines.data();
  std::uint64_t odd = 0, before_is_blank = 1;
  for (std::size_t i = 0; i < size; i += 64) {
    Block block = classify(text + i);
    if (size - i < 64) {
      const std::uint64_t there = (std::uint64_t{1} << (size - i)) - 1;
      block.blank |= ~there;
      block.newline &= there;
      block.control &= there;
    }
    odd |= block.control;
    const std::uint64_t starts = ~block.blank & (block.blank << 1 | before_is_blank);
    before_is_blank = block.blank >> 63;

    const auto at = static_cast<std::uint32_t>(i);
    token = write_places(starts, at, token);

    std::uint64_t newlines = block.newline;
    *line = at + static_cast<std::uint32_t>(std::countr_zero(newlines));
    line += newlines != 0;
    for (newlines &= newlines - 1; newlines != 0; newlines &= newlines - 1)
      *line++ = at + static_cast<std::uint32_t>(std::countr_zero(newlines));
  }
  *token = ~std::uint32_t{0};
  index.tokens = static_cast<std::size_t>(token - index.starts.data());
  index.lines = static_cast<std::size_t>(line - index.newlines.data());
  index.plain = odd == 0;
}

LineCount CountLines(const char* text, std::size_t size) {
  LineCount count;
  std::uint64_t line_begins = 1;
  for (std::size_t i = 0; i < size; i += 64) {
    const std::uint64_t there = size - i < 64 ? (std::uint64_t{1} << (size - i)) - 1 : ~std::uint64_t{0};
    const std::uint64_t newlines = equal_bytes(text + i, '\n') & there;
    const std::uint64_t marks = equal_bytes(text + i, 'I') & there & (newlines << 1 | line_begins);
    line_begins = newlines >> 63;
    count.lines += static_cast<std::size_t>(std::popcount(newlines));
    count.marked += static_cast<std::size_t>(std::popcount(marks));
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainvdb {

HWY_EXPORT(IndexLines);
HWY_EXPORT(CountLines);
HWY_EXPORT(ConvertReals);
HWY_EXPORT(ConvertWholes);

void index_lines(const char* text, std::size_t size, LineIndex& index) {
  HWY_DYNAMIC_DISPATCH(IndexLines)(text, size, index);
}

LineCount count_lines(const char* text, std::size_t size) {
  return HWY_DYNAMIC_DISPATCH(CountLines)(text, size);
}

std::size_t convert_reals(const char* text, const std::uint32_t* starts, std::size_t stride, std::size_t rows,
                          double* values, std::uint32_t* left) {
  return HWY_DYNAMIC_DISPATCH(ConvertReals)(text, starts, stride, rows, values, left);
}

std::size_t convert_wholes(const char* text, const std::uint32_t* starts, std::size_t stride, std::size_t rows,
                           std::int64_t* values, std::uint32_t* left) {
  return HWY_DYNAMIC_DISPATCH(ConvertWholes)(text, starts, stride, rows, values, left);
}

}  // namespace grainvdb
#endif
