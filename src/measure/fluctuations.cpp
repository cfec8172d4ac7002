#include "measure/fluctuations.hpp"

#include <cmath>
#include <map>

#include <Eigen/Dense>

#include "measure/option_values.hpp"

namespace grainvdb {
namespace {

Vec3 mean(const Columns3& columns) {
  Vec3 sum{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (const double x : columns[a]) sum[a] += x;
    sum[a] /= static_cast<double>(columns[a].size());
  }
  return sum;
}

void take_off_mean(Columns3& value) {
  const Vec3 u = mean(value);
  for (std::size_t a = 0; a < 3; ++a)
    for (double& x : value[a]) x -= u[a];
}

// Normal equations about the centre of gravity. Where the grains do not span space (a single layer), the minimum-norm
// solution leaves the gradient across it 0.
void take_off_linear(const Columns3& position, Columns3& value) {
  take_off_mean(value);
  const Vec3 centre = mean(position);
  Eigen::Matrix3d xx = Eigen::Matrix3d::Zero(), xv = Eigen::Matrix3d::Zero();
  const auto vector = [](const Columns3& c, std::size_t i) { return Eigen::Vector3d(c[0][i], c[1][i], c[2][i]); };
  const Eigen::Vector3d origin(centre[0], centre[1], centre[2]);
  for (std::size_t i = 0; i < value[0].size(); ++i) {
    const Eigen::Vector3d x = vector(position, i) - origin;
    xx += x * x.transpose();
    xv += x * vector(value, i).transpose();
  }
  const Eigen::Matrix3d gradient = xx.completeOrthogonalDecomposition().solve(xv);
  for (std::size_t i = 0; i < value[0].size(); ++i) {
    const Eigen::Vector3d u = gradient.transpose() * (vector(position, i) - origin);
    for (std::size_t a = 0; a < 3; ++a) value[a][i] -= u[static_cast<Eigen::Index>(a)];
  }
}

void take_off_layers(const MeanMotion& motion, const Columns3& position, Columns3& value) {
  struct Layer {
    Vec3 sum{};
    double grains = 0;
  };
  std::map<double, Layer> layers;
  const auto layer_of = [&](std::size_t i) { return std::floor(position[motion.axis][i] / motion.thickness); };
  for (std::size_t i = 0; i < value[0].size(); ++i) {
    Layer& layer = layers[layer_of(i)];
    ++layer.grains;
    for (std::size_t a = 0; a < 3; ++a) layer.sum[a] += value[a][i];
  }
  for (std::size_t i = 0; i < value[0].size(); ++i) {
    const Layer& layer = layers[layer_of(i)];
    for (std::size_t a = 0; a < 3; ++a) value[a][i] -= layer.sum[a] / layer.grains;
  }
}

}  // namespace

Columns3 fluctuations(const MeanMotion& motion, const Columns3& position, const Columns3& value) {
  Columns3 result = value;
  if (value[0].empty()) return result;
  switch (motion.kind) {
    case MeanMotion::Kind::none:
      break;
    case MeanMotion::Kind::mean:
      take_off_mean(result);
      break;
    case MeanMotion::Kind::linear:
      take_off_linear(position, result);
      break;
    case MeanMotion::Kind::layers:
      take_off_layers(motion, position, result);
      break;
  }
  return result;
}

std::vector<OptionInfo> mean_motion_options() {
  return {{.name = "about",
           .default_value = std::string("linear"),
           .help = "the mean motion that is taken off in each frame: the mean of the counted grains, the linear flow "
                   "u0 + L x fitted to them, the mean of layers across an axis, or none",
           .choices = {"mean", "linear", "layers", "none"}},
          {.name = "axis",
           .default_value = std::string("z"),
           .help = "the axis that layers lie across",
           .choices = {"x", "y", "z"}},
          {.name = "layer",
           .default_value = 0.0,
           .help = "thickness of layers [length]; 0: the mean diameter of the first frame",
           .minimum = 0}};
}

MeanMotion mean_motion(const OptionValues& options, double diameter) {
  MeanMotion motion;
  const auto& about = std::get<std::string>(options.at("about"));
  if (about == "none") motion.kind = MeanMotion::Kind::none;
  if (about == "linear") motion.kind = MeanMotion::Kind::linear;
  if (about == "layers") motion.kind = MeanMotion::Kind::layers;
  motion.axis = static_cast<std::size_t>(axis_option(options, "axis"));
  motion.thickness = length_option(options, "layer", 1, diameter);
  return motion;
}

}  // namespace grainvdb
