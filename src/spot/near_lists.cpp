#include "spot/near_lists.hpp"

#include <utility>

namespace grainvdb::spot {

void NearLists::reset(std::size_t places) {
  counts_.assign(places, 0);
  members_.clear();
  add_group();
}

void NearLists::join(std::int32_t i, std::int32_t j) {
  add(i, j);
  add(j, i);
}

void NearLists::set(std::int32_t i, std::span<const std::int32_t> neighbours) {
  std::int32_t& count = counts_[static_cast<std::size_t>(i)];
  const std::int32_t before = std::exchange(count, 0);
  for (const std::int32_t j : neighbours)
    if (j != i) add(i, j);
  for (std::int32_t k = count; k < before; ++k) member(i, k) = i;
}

void NearLists::forget(std::int32_t i) {
  std::int32_t& count = counts_[static_cast<std::size_t>(i)];
  for (std::int32_t k = 0; k < count; ++k) {
    remove(std::exchange(member(i, k), i), i);
  }
  count = 0;
}

void NearLists::widen_cells(std::size_t before, std::size_t after) {
  const NearLists old = *this;
  const auto widened = [&](std::size_t i) { return static_cast<std::int32_t>(i / before * after + i % before); };
  reset(counts_.size() / before * after);
  for (std::size_t i = 0; i < old.counts_.size(); ++i)
    for (std::int32_t k = 0; k < old.counts_[i]; ++k)
      add(widened(i), widened(static_cast<std::size_t>(old.view().at(i, static_cast<std::size_t>(k)))));
}

std::int32_t& NearLists::member(std::int32_t i, std::int32_t k) {
  const auto group = static_cast<std::size_t>(k) / NearView::group,
             lane = static_cast<std::size_t>(k) % NearView::group;
  return members_[(group * counts_.size() + static_cast<std::size_t>(i)) * NearView::group + lane];
}

void NearLists::add(std::int32_t i, std::int32_t j) {
  std::int32_t& count = counts_[static_cast<std::size_t>(i)];
  if (static_cast<std::size_t>(count) * counts_.size() == members_.size()) add_group();
  member(i, count++) = j;
}

void NearLists::remove(std::int32_t i, std::int32_t j) {
  const std::int32_t last = --counts_[static_cast<std::size_t>(i)];
  std::int32_t k = 0;
  while (member(i, k) != j) ++k;
  member(i, k) = member(i, last);
  member(i, last) = i;
}

// Places that are not taken hold the particle itself, which it does not push.
void NearLists::add_group() {
  const std::size_t places = counts_.size();
  members_.reserve(members_.size() + places * NearView::group);
  for (std::size_t i = 0; i < places; ++i)
    members_.insert(members_.end(), NearView::group, static_cast<std::int32_t>(i));
}

}  // namespace grainvdb::spot
