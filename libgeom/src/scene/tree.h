#pragma once

/// Binary tree of boxes, each around those below it, the leaves around one item each.

#include "scene/box.h"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

namespace geom::scene {

class BoxTree {
 public:
  /// Node; the first child is the next one in memory.
  struct Node {
    Box3 box;
    std::int32_t item;    ///< item of a leaf; -1 otherwise
    std::int32_t second;  ///< second child; 0 of a leaf
    std::int32_t parent;  ///< -1 of the root
    bool is_leaf() const { return second == 0; }
  };

  /// Builds the tree of some items, boxes[item] around each. A node is split across the longest axis of its centres,
  /// where the sum of area times number of leaves of both parts is least.
  void build(std::vector<std::int32_t> items, std::span<const Box3> boxes);

  /// Gives all items new boxes; the tree stays.
  void refit(std::span<const Box3> boxes);
  /// Gives one item a new box.
  void refit(std::int32_t item, const Box3& box);

  /// Returns the sum of the areas of all nodes: about what queries cost.
  double cost() const { return cost_; }

  bool empty() const { return nodes_.empty(); }
  std::size_t leaves() const { return (nodes_.size() + 1) / 2; }  ///< number of leaves, of removed items too
  std::size_t size() const { return leaf_of_.size(); }            ///< number of items, the largest one plus 1
  const Box3& root() const { return nodes_[0].box; }
  bool has(std::int32_t item) const {
    return static_cast<std::size_t>(item) < leaf_of_.size() && leaf_of_[static_cast<std::size_t>(item)] >= 0;
  }

  /// Calls visit(item, item) for all pairs of leaves whose boxes are no further apart than `cutoff` along any axis,
  /// the second one moved by `by`. `by` = nullptr: pairs of different items, each once; else all ordered pairs. `visit`
  /// returns false to stop. Returns whether it went on to the end.
  template <class Visit>
  bool for_each_pair(double cutoff, const Eigen::Vector3d* by, const Visit& visit) const;

  /// Calls visit(item) for all leaves for which meets(box) holds, of all boxes around them too. `visit` returns false
  /// to stop. Returns whether it went on to the end.
  template <class Meets, class Visit>
  bool for_each(const Meets& meets, const Visit& visit) const;

  /// Calls visit(item) in the order of bound(box), a lower bound of the value of every item in the box, as long as it
  /// is neither above the limit nor infinite. `visit` returns the limit from then on, as this function does.
  template <class Bound, class Visit>
  double in_order(double limit, const Bound& bound, const Visit& visit) const;

 private:
  std::int32_t build(std::span<std::int32_t> items, std::span<const Box3> boxes, std::int32_t parent);
  void enclose_children(Node& node);
  const Node& at(std::int32_t k) const { return nodes_[static_cast<std::size_t>(k)]; }
  Node& at(std::int32_t k) { return nodes_[static_cast<std::size_t>(k)]; }

  std::vector<Node> nodes_;
  std::vector<std::int32_t> leaf_of_;  ///< -1: not in the tree
  double cost_ = 0;
};

template <class Visit>
bool BoxTree::for_each_pair(double cutoff, const Eigen::Vector3d* by, const Visit& visit) const {
  if (nodes_.empty()) return true;
  const Eigen::Vector3d shift = by != nullptr ? *by : Eigen::Vector3d::Zero();
  std::vector<std::pair<std::int32_t, std::int32_t>> open{{0, 0}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const Node& s = at(a);
    const Node& t = at(b);
    if (a == b && by == nullptr) {
      if (s.is_leaf() || s.box.empty()) continue;
      open.emplace_back(a + 1, s.second);
      open.emplace_back(s.second, s.second);
      open.emplace_back(a + 1, a + 1);
      continue;
    }
    const Eigen::Vector3d gap = (s.box.low - t.box.high - shift).cwiseMax(t.box.low + shift - s.box.high);
    if (!(gap.maxCoeff() <= cutoff)) continue;
    if (s.is_leaf() && t.is_leaf()) {
      if (!visit(s.item, t.item)) return false;
    } else if (t.is_leaf() || (!s.is_leaf() && s.box.half_area() >= t.box.half_area())) {
      open.emplace_back(a + 1, b);
      open.emplace_back(s.second, b);
    } else {
      open.emplace_back(a, b + 1);
      open.emplace_back(a, t.second);
    }
  }
  return true;
}

template <class Meets, class Visit>
bool BoxTree::for_each(const Meets& meets, const Visit& visit) const {
  if (nodes_.empty()) return true;
  std::vector<std::int32_t> open{0};
  while (!open.empty()) {
    const std::int32_t k = open.back();
    open.pop_back();
    const Node& node = at(k);
    if (node.box.empty() || !meets(node.box)) continue;
    if (node.is_leaf()) {
      if (!visit(node.item)) return false;
    } else {
      open.push_back(node.second);
      open.push_back(k + 1);
    }
  }
  return true;
}

template <class Bound, class Visit>
double BoxTree::in_order(double limit, const Bound& bound, const Visit& visit) const {
  if (nodes_.empty()) return limit;
  using Open = std::pair<double, std::int32_t>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  const auto add = [&](std::int32_t k) {
    if (at(k).box.empty()) return;
    const double least = bound(at(k).box);
    if (least <= limit && std::isfinite(least)) open.emplace(least, k);
  };
  add(0);
  while (!open.empty()) {
    const auto [least, k] = open.top();
    open.pop();
    if (!(least <= limit)) return limit;
    const Node& node = at(k);
    if (node.is_leaf()) {
      limit = visit(node.item);
    } else {
      add(k + 1);
      add(node.second);
    }
  }
  return limit;
}

}  // namespace geom::scene
