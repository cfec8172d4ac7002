#include "measure/free_surface.hpp"

#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "base/nan.hpp"
#include "measure/cell_grid.hpp"

namespace grainvdb {

void FreeSurface::add(const Box& box, const Columns3& position, const std::vector<double>& radius) {
  const std::array<std::size_t, 2> level{(vertical_ + 1) % 3, (vertical_ + 2) % 3};
  std::map<std::pair<long, long>, Vec3> highest;
  for (std::size_t i = 0; i < radius.size(); ++i) {
    std::array<double, 2> x{};
    std::array<long, 2> column{};
    for (std::size_t b = 0; b < 2; ++b) {
      x[b] = box.wrap(static_cast<int>(level[b]), position[level[b]][i]);
      column[b] = std::lround(std::floor(x[b] / width_));
    }
    const Vec3 top{x[0], x[1], position[vertical_][i] + radius[i]};
    const auto [it, is_new] = highest.try_emplace({column[0], column[1]}, top);
    if (!is_new && top[2] > it->second[2]) it->second = top;
  }
  for (const auto& [column, top] : highest) {
    Top& sum = tops_[column];
    ++sum.frames;
    for (std::size_t a = 0; a < 3; ++a) sum.at[a] += top[a];
  }
  for (std::size_t b = 0; b < 2; ++b) sloped_[b] = !box.periodic[level[b]];
}

SurfacePlane FreeSurface::plane() const {
  SurfacePlane result{nan, nan, {nan, nan}, {nan, nan}, nan, nan, nan, tops_.size()};
  const auto rows = static_cast<Eigen::Index>(tops_.size());
  const Eigen::Index unknowns = 1 + (sloped_[0] ? 1 : 0) + (sloped_[1] ? 1 : 0);
  if (unknowns == 1 || rows <= unknowns) return result;
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(rows, unknowns);
  Eigen::VectorXd h(rows);
  Eigen::Index row = 0;
  for (const auto& [column, top] : tops_) {
    Eigen::Index u = 1;
    for (std::size_t b = 0; b < 2; ++b)
      if (sloped_[b]) x(row, u++) = top.at[b] / top.frames;
    h[row++] = top.at[2] / top.frames;
  }
  // About the middle, where the height is then independent of the slopes.
  const Eigen::RowVectorXd middle = x.rightCols(unknowns - 1).colwise().mean();
  x.rightCols(unknowns - 1).rowwise() -= middle;
  const auto solver = x.colPivHouseholderQr();
  if (solver.rank() < unknowns) return result;
  const Eigen::VectorXd fit = solver.solve(h);
  const double variance = (h - x * fit).squaredNorm() / static_cast<double>(rows - unknowns);
  const Eigen::MatrixXd covariance = variance * (x.transpose() * x).inverse();

  result.height = fit[0];
  result.height_error = std::sqrt(covariance(0, 0));
  result.roughness = std::sqrt(variance);
  const Eigen::VectorXd s = fit.tail(unknowns - 1);
  const Eigen::MatrixXd c = covariance.bottomRightCorner(unknowns - 1, unknowns - 1);
  Eigen::Index u = 0;
  for (std::size_t b = 0; b < 2; ++b) {
    result.slope[b] = sloped_[b] ? s[u] : 0;
    result.slope_error[b] = sloped_[b] ? std::sqrt(c(u, u)) : 0;
    u += sloped_[b] ? 1 : 0;
  }
  // dα = (s·ds)/(|s| (1 + s²)); without a slope its direction is any, and the mean over directions is taken.
  const double steepness = s.norm();
  const double along =
      steepness > 0 ? s.dot(c * s) / (steepness * steepness) : c.trace() / static_cast<double>(s.size());
  result.angle = std::atan(steepness);
  result.angle_error = std::sqrt(along) / (1 + steepness * steepness);
  return result;
}

std::vector<bool> supported(const Box& box, const Columns3& position, double reach, std::size_t least) {
  std::vector<bool> result(position[0].size());
  if (result.empty()) return result;
  const CellGrid grid(box, position, reach);
  for (std::size_t i = 0; i < result.size(); ++i) {
    std::size_t count = 0;
    grid.neighbours(i, [&](std::size_t, const Vec3&, double) { ++count; });
    result[i] = count >= least;
  }
  return result;
}

}  // namespace grainvdb
