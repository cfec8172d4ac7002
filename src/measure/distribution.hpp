#pragma once
/// How values of voxels are distributed.
#include <cstddef>
#include <string>
#include <vector>

#include "grainvdb/table.hpp"
#include "measure/histogram.hpp"
#include "measure/weighted_sample.hpp"

namespace grainvdb {

class Distribution {
 public:
  /// Bins over lo … hi; `independence` is the part of a value that no other tells, 0 … 1.
  Distribution(double lo, double hi, std::size_t bins, double independence)
      : independence_(independence), histogram_(lo, hi, bins) {}

  /// A weight of NaN counts for nothing, a value of NaN as undefined.
  void add(double value, double weight);

  bool empty() const { return sample_.size() == 0; }
  const Histogram& histogram() const { return histogram_; }
  double mean() const { return sample_.mean(); }
  double spread() const { return sample_.spread(); }
  Quantity mean_of(const std::string& what) const;
  Quantity spread_of(const std::string& what) const;
  /// mean, spread, five quantiles, undefined_share and outside_share of `what`, which the descriptions name.
  std::vector<Quantity> numbers(const std::string& what) const;

 private:
  double independence_;
  Histogram histogram_;
  WeightedSample sample_;
  double offered_ = 0;
};

}  // namespace grainvdb
