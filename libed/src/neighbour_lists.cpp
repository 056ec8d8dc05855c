#include "neighbour_lists.h"

#include <algorithm>

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
