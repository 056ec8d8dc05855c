#pragma once

/// Boxes of bodies that come, go and move, and queries of them: a tree that is brought up to date when it is asked.

#include "scene/tree.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

namespace geom::scene {

/// Makes room for a number of elements, so that adding them does not throw.
template <class T>
void make_room(std::vector<T>& elements, std::size_t size) {
  if (elements.capacity() < size) elements.reserve(std::max(size, 2 * elements.capacity()));
}

class BroadPhase {
 public:
  /// `margin`: length by which boxes are larger than asked for, so that small moves change nothing.
  explicit BroadPhase(double margin) : margin_(margin) {}

  /// Adds a box and returns its item, the lowest that is free. Changes nothing if there is no memory.
  std::int32_t add(const Box3& tight);
  void remove(std::int32_t item) noexcept;
  void move(std::int32_t item, const Box3& tight) noexcept;

  const Box3& tight(std::int32_t item) const { return tight_[static_cast<std::size_t>(item)]; }
  /// Returns a box around all.
  Box3 bounds() const;

  /// Functions of BoxTree, with the items that are not in the tree yet.
  /// @{
  template <class Visit>
  bool for_each_pair(double cutoff, const Eigen::Vector3d* by, const Visit& visit) const;
  template <class Meets, class Visit>
  bool for_each(const Meets& meets, const Visit& visit) const;
  template <class Bound, class Visit>
  void in_order(double limit, const Bound& bound, const Visit& visit) const;
  /// @}

 private:
  const BoxTree& tree() const;
  void bring_up_to_date() const;
  void set_box(std::int32_t item, const Box3& tight) noexcept;
  void mark_changed(std::int32_t item) noexcept;
  const Box3& box(std::int32_t item) const { return boxes_[static_cast<std::size_t>(item)]; }

  double margin_;
  std::vector<Box3> tight_;
  std::vector<Box3> boxes_;         ///< boxes with the margin; empty of free items
  std::vector<std::int32_t> free_;  ///< a heap, the lowest on top

  // What const functions bring up to date, one thread at a time.
  mutable std::mutex mutex_;
  mutable std::atomic<bool> current_ = true;
  mutable BoxTree tree_;
  mutable double built_cost_ = 0;
  mutable std::vector<std::int32_t> changed_;  ///< items in the tree whose boxes are new
  mutable std::vector<std::int32_t> loose_;    ///< items that are not in the tree
};

template <class Visit>
bool BroadPhase::for_each_pair(double cutoff, const Eigen::Vector3d* by, const Visit& visit) const {
  const BoxTree& all = tree();
  if (!all.for_each_pair(cutoff, by, visit)) return false;
  const auto near = [&](const Box3& a, const Box3& b) {
    return ((a.low - b.high).cwiseMax(b.low - a.high)).maxCoeff() <= cutoff;
  };
  for (std::size_t k = 0; k < loose_.size(); ++k) {
    const std::int32_t a = loose_[k];
    const Box3 ahead = by == nullptr ? box(a) : box(a).moved(-*by);
    if (!all.for_each([&](const Box3& b) { return near(ahead, b); }, [&](std::int32_t b) { return visit(a, b); })) {
      return false;
    }
    if (by != nullptr) {
      const Box3 moved = box(a).moved(*by);
      if (!all.for_each([&](const Box3& b) { return near(moved, b); }, [&](std::int32_t b) { return visit(b, a); })) {
        return false;
      }
    }
    for (std::size_t m = by == nullptr ? k + 1 : 0; m < loose_.size(); ++m) {
      if (near(ahead, box(loose_[m])) && !visit(a, loose_[m])) return false;
    }
  }
  return true;
}

template <class Meets, class Visit>
bool BroadPhase::for_each(const Meets& meets, const Visit& visit) const {
  if (!tree().for_each(meets, visit)) return false;
  for (const std::int32_t item : loose_) {
    if (meets(box(item)) && !visit(item)) return false;
  }
  return true;
}

template <class Bound, class Visit>
void BroadPhase::in_order(double limit, const Bound& bound, const Visit& visit) const {
  limit = tree().in_order(limit, bound, visit);
  for (const std::int32_t item : loose_) {
    const double least = bound(box(item));
    if (least <= limit && std::isfinite(least)) limit = visit(item);
  }
}

}  // namespace geom::scene
