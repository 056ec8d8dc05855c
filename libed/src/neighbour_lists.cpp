#include "neighbour_lists.h"

#include <algorithm>
#include <cmath>

namespace ed::internal {

std::int32_t NeighbourLists::add(std::int32_t i, std::int32_t j, const Eigen::Vector3d& normal) {
  std::int32_t index;
  if (free_.empty()) {
    index = static_cast<std::int32_t>(pairs_.size());
    pairs_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  std::vector<std::int32_t>& list_i = of_body_[static_cast<std::size_t>(i)];
  std::vector<std::int32_t>& list_j = of_body_[static_cast<std::size_t>(j)];
  Pair& p = pair(index);
  p.time = kNever;
  p.event = PairEvent::clear;
  p.normal = normal;
  p.i = i;
  p.j = j;
  p.owner = i;
  p.slot_i = static_cast<std::int32_t>(list_i.size());
  p.slot_j = static_cast<std::int32_t>(list_j.size());
  list_i.push_back(index);
  list_j.push_back(index);
  return index;
}

void NeighbourLists::remove(std::int32_t index) {
  const Pair p = pair(index);
  unlink(p.i, p.slot_i);
  unlink(p.j, p.slot_j);
  free_.push_back(index);
}

std::size_t NeighbourLists::reserve() {
  std::size_t longest = 0;
  for (const std::vector<std::int32_t>& list : of_body_) longest = std::max(longest, list.size());
  for (std::vector<std::int32_t>& list : of_body_) list.reserve(2 * longest);
  pairs_.reserve(2 * pairs_.size());
  free_.reserve(pairs_.capacity());
  return 2 * longest;
}

bool NeighbourLists::lists(std::int32_t body, std::int32_t index) const {
  if (body < 0 || body >= number() || index < 0 || static_cast<std::size_t>(index) >= pairs_.size()) return false;
  const Pair& p = pair(index);
  if (p.i != body && p.j != body) return false;
  const std::int32_t slot = p.i == body ? p.slot_i : p.slot_j;
  const std::vector<std::int32_t>& list = of(body);
  return slot >= 0 && static_cast<std::size_t>(slot) < list.size() && list[static_cast<std::size_t>(slot)] == index;
}

/// Every pair is in the lists of its two bodies and nowhere else, or free.
bool NeighbourLists::linked() const {
  std::vector<bool> free(pairs_.size(), false);
  for (const std::int32_t index : free_) {
    if (index < 0 || static_cast<std::size_t>(index) >= free.size() || free[static_cast<std::size_t>(index)]) {
      return false;
    }
    free[static_cast<std::size_t>(index)] = true;
  }
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Pair& p = pairs_[k];
    const auto index = static_cast<std::int32_t>(k);
    if (free[k]) continue;
    const bool sound = p.i != p.j && (p.owner == p.i || p.owner == p.j) && p.event >= PairEvent::clear &&
                       p.event <= PairEvent::contact && p.normal.allFinite() && !std::isnan(p.time);
    if (!sound || !lists(p.i, index) || !lists(p.j, index)) return false;
  }
  std::size_t places = 0;
  for (const std::vector<std::int32_t>& list : of_body_) places += list.size();
  return places == 2 * (pairs_.size() - free_.size());
}

void NeighbourLists::unlink(std::int32_t body, std::int32_t slot) {
  std::vector<std::int32_t>& list = of_body_[static_cast<std::size_t>(body)];
  const std::int32_t moved = list.back();
  list[static_cast<std::size_t>(slot)] = moved;
  list.pop_back();
  if (static_cast<std::size_t>(slot) == list.size()) return;
  Pair& p = pair(moved);
  (p.i == body ? p.slot_i : p.slot_j) = slot;
}

}  // namespace ed::internal
