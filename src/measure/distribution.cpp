#include "measure/distribution.hpp"

#include <cmath>

namespace grainvdb {

void Distribution::add(double value, double weight) {
  if (std::isnan(weight)) return;
  offered_ += weight;
  histogram_.add(value, weight);
  sample_.add(value, weight);
}

Quantity Distribution::mean_of(const std::string& what) const {
  return {.name = "mean",
          .value = mean(),
          .error = sample_.mean_error(independence_),
          .description = "weighted mean of " + what + "; error as if nothing were correlated beyond the kernel"};
}

Quantity Distribution::spread_of(const std::string& what) const {
  return {.name = "spread", .value = spread(), .description = "weighted standard deviation of " + what};
}

std::vector<Quantity> Distribution::numbers(const std::string& what) const {
  std::vector<Quantity> all{mean_of(what), spread_of(what)};
  for (int percent : {5, 25, 50, 75, 95})
    all.push_back({.name = "quantile_" + std::to_string(percent),
                   .value = sample_.quantile(percent / 100.0),
                   .description = what + " below which " + std::to_string(percent) + " % of the weight lie"});
  all.push_back({.name = "undefined_share",
                 .value = 1 - sample_.weight() / offered_,
                 .description = "weight of voxels without " + what});
  all.push_back({.name = "outside_share",
                 .value = histogram_.outside(),
                 .description = "weight beyond the histogram, which the other numbers hold"});
  return all;
}

}  // namespace grainvdb
