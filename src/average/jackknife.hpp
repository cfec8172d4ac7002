#pragma once
/// The standard error of a field from what it would be without each block of frames.
#include <cstddef>
#include <vector>

#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

/// The delete-a-group jackknife for B groups of unequal size (Busing, Meijer and van der Leeden 1999). With h_j =
/// N/m_j, N frames over the m_j of block j, and d_j the field without block j less the field:
///
///     error² = 1/B Σ_j ((h_j - 1) d_j - D)²/(h_j - 1),   D = Σ_j (1 - 1/h_j) d_j.
///
/// For a mean this is the spread of the block means, (1/B) Σ_j (mean_j - mean)²/(h_j - 1), which for independent frames
/// is σ²/N on average whatever the sizes; for a smooth function of means it is that to first order. It holds where
/// blocks are longer than the time over which the frames are correlated; shorter ones make it too small. As fields are
/// stored in single precision, nothing below 1e-7 √B of a field is resolved.
class Jackknife {
 public:
  /// `frames` are those of each block, `whole` the field from all of them, which must outlive this.
  Jackknife(const SparseField& whole, const std::vector<std::size_t>& frames);

  /// The field without block j, on the topology of the whole. Each block once.
  void leave_out(std::size_t block, const SparseField& without);

  /// The error of a component in a leaf at an offset; NaN where the field or one without a block is not defined.
  double error(std::size_t leaf, int component, int offset) const;

  /// Bytes that a leaf of a component takes.
  static constexpr std::size_t bytes_per_leaf() { return leaf_size * sizeof(Sums); }

 private:
  /// Σ (h-1) d², Σ d and Σ (1-1/h) d.
  struct Sums {
    double squares = 0, plain = 0, weighed = 0;
  };
  std::size_t at(std::size_t leaf, int component, int offset) const;

  const SparseField& whole_;
  std::vector<double> ratio_;  // h_j
  double inverse_ = 0;         // Σ 1/(h-1)
  std::vector<Sums> sums_;     // [leaf][component][offset]
};

}  // namespace grainvdb
