#include "scene/tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace geom::scene {

using Eigen::Vector3d;

namespace {

constexpr int kPlanes = 16;  ///< intervals of an axis, between which nodes may be split

/// Leaves whose centres are in one interval.
struct Interval {
  Box3 box;
  std::size_t count = 0;
};

/// Moves the items of the cheapest left part to the front, and returns how many they are.
std::size_t split(std::span<std::int32_t> items, std::span<const Box3> boxes) {
  Box3 centres;
  for (const std::int32_t item : items) {
    const Vector3d c = boxes[static_cast<std::size_t>(item)].centre();
    centres.add({c, c});
  }
  Eigen::Index axis = 0;
  const double width = (centres.high - centres.low).maxCoeff(&axis);
  const auto half = items.begin() + static_cast<std::ptrdiff_t>(items.size() / 2);
  const auto centre = [&](std::int32_t item) { return boxes[static_cast<std::size_t>(item)].centre()[axis]; };
  const auto in_the_middle = [&] {
    std::nth_element(items.begin(), half, items.end(),
                     [&](std::int32_t a, std::int32_t b) { return std::pair(centre(a), a) < std::pair(centre(b), b); });
    return items.size() / 2;
  };
  if (!(width > 0) || items.size() < 5) return in_the_middle();

  const auto interval_of = [&](std::int32_t item) {
    const double place = (centre(item) - centres.low[axis]) * (kPlanes / width);
    return std::clamp(static_cast<int>(place), 0, kPlanes - 1);
  };
  std::array<Interval, kPlanes> intervals;
  for (const std::int32_t item : items) {
    Interval& interval = intervals[static_cast<std::size_t>(interval_of(item))];
    interval.box.add(boxes[static_cast<std::size_t>(item)]);
    ++interval.count;
  }
  const auto cost = [](const Interval& part) {
    return part.count == 0 ? 0 : static_cast<double>(part.count) * part.box.half_area();
  };
  std::array<double, kPlanes> of_right{};
  Interval right;
  for (std::size_t k = kPlanes - 1; k > 0; --k) {
    right.box.add(intervals[k].box);
    right.count += intervals[k].count;
    of_right[k] = cost(right);
  }
  Interval left;
  double least = std::numeric_limits<double>::infinity();
  int first_of_right = 0;
  for (std::size_t k = 1; k < kPlanes; ++k) {
    left.box.add(intervals[k - 1].box);
    left.count += intervals[k - 1].count;
    if (left.count == 0 || left.count == items.size()) continue;
    const double both = cost(left) + of_right[k];
    if (both < least) {
      least = both;
      first_of_right = static_cast<int>(k);
    }
  }
  if (first_of_right == 0) return in_the_middle();
  const auto end =
      std::partition(items.begin(), items.end(), [&](std::int32_t item) { return interval_of(item) < first_of_right; });
  return static_cast<std::size_t>(end - items.begin());
}

}  // namespace

std::int32_t BoxTree::build(std::span<std::int32_t> items, std::span<const Box3> boxes, std::int32_t parent) {
  const auto place = static_cast<std::int32_t>(nodes_.size());
  if (items.size() == 1) {
    leaf_of_[static_cast<std::size_t>(items[0])] = place;
    nodes_.push_back({boxes[static_cast<std::size_t>(items[0])], items[0], 0, parent});
    return place;
  }
  nodes_.push_back({{}, -1, 0, parent});
  const std::size_t left = split(items, boxes);
  build(items.first(left), boxes, place);
  const std::int32_t second = build(items.subspan(left), boxes, place);
  at(place).second = second;
  enclose_children(at(place));
  return place;
}

void BoxTree::build(std::vector<std::int32_t> items, std::span<const Box3> boxes) {
  nodes_.clear();
  leaf_of_.assign(boxes.size(), -1);
  cost_ = 0;
  if (items.empty()) return;
  nodes_.reserve(2 * items.size() - 1);
  build(items, boxes, -1);
  for (const Node& node : nodes_) cost_ += node.box.half_area();
}

void BoxTree::refit(std::span<const Box3> boxes) {
  cost_ = 0;
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    if (node->is_leaf()) {
      node->box = boxes[static_cast<std::size_t>(node->item)];
    } else {
      enclose_children(*node);
    }
    cost_ += node->box.half_area();
  }
}

void BoxTree::refit(std::int32_t item, const Box3& box) {
  std::int32_t k = leaf_of_[static_cast<std::size_t>(item)];
  cost_ += box.half_area() - at(k).box.half_area();
  at(k).box = box;
  while ((k = at(k).parent) >= 0) {
    Node& node = at(k);
    const Box3 before = node.box;
    enclose_children(node);
    if (node.box.low == before.low && node.box.high == before.high) return;
    cost_ += node.box.half_area() - before.half_area();
  }
}

void BoxTree::enclose_children(Node& node) {
  const Node* first = &node + 1;
  node.box = first->box;
  node.box.add(at(node.second).box);
}

}  // namespace geom::scene
