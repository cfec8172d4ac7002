#include "measure/contact_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "measure/cell_grid.hpp"

namespace grainvdb {
namespace {

/// The angle between two vectors, accurate near 0 and π (acos is not).
double angle_between(const Vec3& a, const Vec3& b) {
  const Vec3 cross{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  return std::atan2(std::hypot(cross[0], cross[1], cross[2]), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

}  // namespace

ContactGraph contacts_by_gap(const Box& box, const Columns3& position, const std::vector<double>& radius, double gap) {
  ContactGraph graph;
  if (radius.empty()) return graph;
  const CellGrid grid(box, position, 2 * *std::max_element(radius.begin(), radius.end()) + gap);
  for (std::size_t i = 0; i < radius.size(); ++i) {
    grid.neighbours(i, [&](std::size_t j, const Vec3& r, double r2) {
      if (std::sqrt(r2) - radius[i] - radius[j] > gap) return;
      graph.partner.push_back(static_cast<std::uint32_t>(j));
      graph.branch.push_back(r);
    });
    graph.start.push_back(graph.partner.size());
  }
  return graph;
}

ContactGraph contacts_of_dump(const Particles& particles, const Contacts& contacts) {
  const auto& id = particles.id;
  const auto index = [&](std::int64_t wanted) {
    const auto it = std::lower_bound(id.begin(), id.end(), wanted);
    return it == id.end() || *it != wanted ? ContactGraph::outside : static_cast<std::uint32_t>(it - id.begin());
  };
  ContactGraph graph;
  graph.start.assign(id.size() + 1, 0);
  std::vector<std::uint32_t> first(contacts.size()), second(contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    first[c] = index(contacts.id1[c]);
    second[c] = index(contacts.id2[c]);
    for (const std::uint32_t i : {first[c], second[c]})
      if (i != ContactGraph::outside) ++graph.start[i + 1];
  }
  std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
  graph.partner.resize(graph.start.back());
  std::vector<std::size_t> next(graph.start.begin(), graph.start.end() - 1);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (first[c] != ContactGraph::outside) graph.partner[next[first[c]]++] = second[c];
    if (second[c] != ContactGraph::outside) graph.partner[next[second[c]]++] = first[c];
  }
  return graph;
}

std::vector<bool> backbone(const ContactGraph& graph, std::size_t least) {
  std::vector<bool> stays(graph.size(), true);
  std::vector<std::size_t> left(graph.size());
  std::vector<std::size_t> to_take;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    left[i] = graph.degree(i);
    if (left[i] >= least) continue;
    stays[i] = false;
    to_take.push_back(i);
  }
  while (!to_take.empty()) {
    const std::size_t i = to_take.back();
    to_take.pop_back();
    for (std::size_t c = graph.start[i]; c < graph.start[i + 1]; ++c) {
      const std::uint32_t j = graph.partner[c];
      if (j == ContactGraph::outside || !stays[j] || --left[j] >= least) continue;
      stays[j] = false;
      to_take.push_back(j);
    }
  }
  return stays;
}

void BondAngles::add(const ContactGraph& graph, std::size_t i) {
  const double per_radian = static_cast<double>(bins()) / std::numbers::pi;
  for (std::size_t a = graph.start[i]; a < graph.start[i + 1]; ++a)
    for (std::size_t b = a + 1; b < graph.start[i + 1]; ++b) {
      const double angle = angle_between(graph.branch[a], graph.branch[b]);
      ++counts_[std::min(bins() - 1, static_cast<std::size_t>(angle * per_radian))];
    }
}

double BondAngles::edge(std::size_t k) const {
  return std::numbers::pi * static_cast<double>(k) / static_cast<double>(bins());
}

double BondAngles::total() const {
  return std::accumulate(counts_.begin(), counts_.end(), 0.0);
}

double BondAngles::density(std::size_t k) const {
  return counts_[k] / total() / (edge(k + 1) - edge(k));
}

double BondAngles::relative(std::size_t k) const {
  return counts_[k] / total() / (0.5 * (std::cos(edge(k)) - std::cos(edge(k + 1))));
}

}  // namespace grainvdb
