#include "measure/time_sums.hpp"

#include "measure/jackknife_error.hpp"

namespace grainvdb {

std::vector<Estimate> jackknife(std::size_t times, std::size_t outputs,
                                const std::function<void(std::optional<std::size_t>, std::span<double>)>& f) {
  std::vector<double> values(outputs);
  f({}, values);
  std::vector<std::vector<double>> without(outputs, std::vector<double>(times));  // [output][time]
  if (times > 1) {
    std::vector<double> left(outputs);
    for (std::size_t t = 0; t < times; ++t) {
      f(t, left);
      for (std::size_t k = 0; k < outputs; ++k) without[k][t] = left[k];
    }
  }
  std::vector<Estimate> all;
  for (std::size_t k = 0; k < outputs; ++k) all.push_back({values[k], jackknife_error(without[k])});
  return all;
}

std::span<double> TimeSums::at(std::int64_t bin) {
  std::vector<double>& sums = sums_[bin];
  if (sums.size() < times_ * channels_) sums.resize(times_ * channels_);
  return {sums.data() + (times_ - 1) * channels_, channels_};
}

std::vector<std::int64_t> TimeSums::bins() const {
  std::vector<std::int64_t> all;
  for (const auto& [bin, sums] : sums_) all.push_back(bin);
  return all;
}

std::vector<double> TimeSums::total(std::int64_t bin, std::optional<std::size_t> without) const {
  std::vector<double> sum(channels_);
  const auto found = sums_.find(bin);
  if (found == sums_.end()) return sum;
  for (std::size_t k = 0; k < found->second.size(); ++k)
    if (without != k / channels_) sum[k % channels_] += found->second[k];
  return sum;
}

}  // namespace grainvdb
