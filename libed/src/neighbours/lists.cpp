#include "neighbours/lists.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
  Pair& p = pair(index);
  p.time = kNever;
  p.event = PairEvent::clear;
  p.normal = normal;
  p.i = i;
  p.j = j;
  p.owner = i;
  p.slot_i = append(i, index);
  p.slot_j = append(j, index);
  return index;
}

std::size_t NeighbourLists::reserve() {
  std::size_t longest = 0;
  for (const std::uint32_t length : lengths_) longest = std::max(longest, std::size_t{length});
  const std::size_t room = std::min(2 * longest, most_room());
  if (room > room_) make_room(room);
  for (auto& [body, list] : long_) list.reserve(2 * longest);
  pairs_.reserve(2 * pairs_.size());
  free_.reserve(pairs_.capacity());
  return 2 * longest;
}

bool NeighbourLists::lists(std::int32_t body, std::int32_t index) const {
  if (body < 0 || body >= number() || index < 0 || static_cast<std::size_t>(index) >= pairs_.size()) return false;
  const Pair& p = pair(index);
  if (p.i != body && p.j != body) return false;
  const std::int32_t slot = p.i == body ? p.slot_i : p.slot_j;
  const auto list = of(body);
  return slot >= 0 && static_cast<std::size_t>(slot) < list.size() && list[static_cast<std::size_t>(slot)] == index;
}

/// Returns whether every pair is in the lists of its two bodies and nowhere else, or free.
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
  for (const std::uint32_t length : lengths_) places += length;
  return places == 2 * (pairs_.size() - free_.size());
}

/// Appends the pair to the list of the body, and returns its slot.
std::int32_t NeighbourLists::append(std::int32_t body, std::int32_t index) {
  const auto at = static_cast<std::size_t>(body);
  const std::size_t length = lengths_[at];
  if (length == room_ && room_ < most_room()) make_room(std::min(2 * room_ + 8, most_room()));
  if (length < room_) {
    list_of(at)[length] = index;
  } else {
    std::vector<std::int32_t>& list = long_[body];
    if (length == room_) list.assign(list_of(at), list_of(at) + room_);
    list.push_back(index);
  }
  return static_cast<std::int32_t>(lengths_[at]++);
}

void NeighbourLists::unlink(std::int32_t body, std::int32_t slot) {
  const auto at = static_cast<std::size_t>(body);
  const bool is_long = lengths_[at] > room_;
  std::int32_t* list = is_long ? long_.at(body).data() : list_of(at);
  const std::uint32_t last = --lengths_[at];
  const std::int32_t moved = list[last];
  list[slot] = moved;
  if (is_long) {
    long_.at(body).pop_back();
    if (last == room_) std::copy_n(list, room_, list_of(at));
  }
  if (static_cast<std::uint32_t>(slot) == last) return;
  Pair& p = pair(moved);
  (p.i == body ? p.slot_i : p.slot_j) = slot;
}

/// Returns the most room that each body is given: several times the mean.
std::size_t NeighbourLists::most_room() const {
  constexpr std::size_t kAlways = 64;
  return std::max(kAlways, 8 * (pairs_.size() - std::min(free_.size(), pairs_.size())) / lengths_.size());
}

/// Sets the lists, one for each body; the pairs are set already.
void NeighbourLists::assign(const std::vector<std::vector<std::int32_t>>& lists) {
  std::size_t longest = 0;
  for (const std::vector<std::int32_t>& list : lists) longest = std::max(longest, list.size());
  long_.clear();
  std::fill(lengths_.begin(), lengths_.end(), 0);
  make_room(std::min(longest, most_room()));
  for (std::size_t body = 0; body < lists.size(); ++body) {
    const std::vector<std::int32_t>& list = lists[body];
    if (list.size() > room_) {
      long_[static_cast<std::int32_t>(body)] = list;
    } else {
      std::copy(list.begin(), list.end(), list_of(body));
    }
    lengths_[body] = static_cast<std::uint32_t>(list.size());
  }
}

/// Gives each list this room, no less than now.
void NeighbourLists::make_room(std::size_t room) {
  LargeVector<std::int32_t> slots(room * lengths_.size());
  for (std::size_t body = 0; body < lengths_.size(); ++body) {
    const std::size_t length = lengths_[body];
    if (length > room) continue;
    const std::int32_t* const list = length > room_ ? long_.at(static_cast<std::int32_t>(body)).data() : list_of(body);
    std::copy_n(list, length, slots.data() + body * room);
  }
  slots_ = std::move(slots);
  room_ = room;
}

}  // namespace ed::internal
