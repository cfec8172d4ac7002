#pragma once
/// Fields that are a formula of other fields at the same voxel.
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "grainvdb/stage.hpp"

namespace grainvdb {

/// A field that a formula reads: its name and its number of components.
template <std::size_t N>
struct Input {
  const char* name;
};
using ScalarInput = Input<1>;
using VectorInput = Input<3>;
using TensorInput = Input<9>;

/// What a formula sees of, or returns for, a field of N components.
template <std::size_t N>
using VoxelValue = std::conditional_t<N == 1, double, std::array<double, N>>;

/// Where a formula notes why it has no value at its voxel.
class VoxelNotes {
 public:
  VoxelNotes(Mask& mask, std::size_t leaf, int offset) : mask_(mask), leaf_(leaf), offset_(offset) {}
  void add(Reason reason) { mask_.add(leaf_, offset_, reason); }
  /// Adds the reason and gives the value to return: NaN.
  double undefined(Reason reason) {
    add(reason);
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  Mask& mask_;
  std::size_t leaf_;
  int offset_;
};

namespace detail {

inline bool is_nan(double v) {
  return std::isnan(v);
}
template <std::size_t N>
bool is_nan(const std::array<double, N>& v) {
  for (double x : v)
    if (std::isnan(x)) return true;
  return false;
}

template <class Value>
Value nan_value() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if constexpr (std::is_same_v<Value, double>) {
    return nan;
  } else {
    Value v;
    v.fill(nan);
    return v;
  }
}

template <std::size_t N>
class LeafReader {
 public:
  LeafReader(const SparseField& field, std::size_t leaf) {
    for (std::size_t c = 0; c < N; ++c) data_[c] = field.leaf(leaf, static_cast<int>(c));
  }
  VoxelValue<N> operator()(int offset) const {
    if constexpr (N == 1) {
      return static_cast<double>(data_[0][offset]);
    } else {
      std::array<double, N> v;
      for (std::size_t c = 0; c < N; ++c) v[c] = static_cast<double>(data_[c][offset]);
      return v;
    }
  }

 private:
  std::array<const float*, N> data_;
};

template <std::size_t N>
struct BoundInput {
  const SparseField& field;
  LeafReader<N> reader(std::size_t leaf) const { return LeafReader<N>(field, leaf); }
};

inline void store(SparseField& out, std::size_t leaf, int offset, double v) {
  out.leaf(leaf)[offset] = static_cast<float>(v);
}
template <std::size_t N>
void store(SparseField& out, std::size_t leaf, int offset, const std::array<double, N>& v) {
  for (std::size_t c = 0; c < N; ++c) out.leaf(leaf, static_cast<int>(c))[offset] = static_cast<float>(v[c]);
}

}  // namespace detail

/// out = f(notes, values of the inputs...) at every active voxel, leaves in parallel, computed in double. Where any
/// component of an input is NaN the result is NaN without a call of f: the stage that made the input has given the
/// reason.
template <class F, std::size_t... N>
void for_each_voxel(const StageInput& in, SparseField& out, const F& f, Input<N>... inputs) {
  using Result = std::invoke_result_t<const F&, VoxelNotes&, VoxelValue<N>...>;
  const std::tuple<detail::BoundInput<N>...> bound{detail::BoundInput<N>{in.field(inputs.name)}...};
  for_each_leaf(in.topology(), [&](std::size_t leaf) {
    const std::tuple<detail::LeafReader<N>...> readers =
        std::apply([leaf](const auto&... b) { return std::tuple{b.reader(leaf)...}; }, bound);
    in.topology().mask(leaf).for_each([&](int offset) {
      VoxelNotes notes(in.mask(), leaf, offset);
      const std::tuple<VoxelValue<N>...> values =
          std::apply([offset](const auto&... read) { return std::tuple{read(offset)...}; }, readers);
      const Result result = std::apply(
          [&](const auto&... v) { return (detail::is_nan(v) || ...) ? detail::nan_value<Result>() : f(notes, v...); },
          values);
      detail::store(out, leaf, offset, result);
    });
  });
}

/// Makes `stage` a formula of the inputs: they become its needs, and `make(settings)` gives the function of
/// (VoxelNotes&, values...) that for_each_voxel applies.
template <class Make, std::size_t... N>
void set_formula(Stage& stage, const Make& make, Input<N>... inputs) {
  stage.needs = [inputs...](const StageSettings&) { return StageNeeds{std::vector<std::string>{inputs.name...}, {}}; };
  stage.compute = [make, inputs...](const StageInput& in, SparseField& out) {
    for_each_voxel(in, out, make(in.settings()), inputs...);
  };
}

}  // namespace grainvdb
