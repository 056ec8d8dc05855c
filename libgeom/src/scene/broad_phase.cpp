#include "scene/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace geom::scene {

namespace {

constexpr std::size_t kFewItems = 32;  ///< number of items that may always stay outside the tree, or stay in it removed
constexpr std::size_t kChangedShare = 8;  ///< share, its inverse, from which on all boxes are fitted at once
constexpr double kWorseTree = 1.5;        ///< growth of the cost from which on the tree is built again

}  // namespace

void BroadPhase::set_box(std::int32_t item, const Box3& tight) noexcept {
  const auto k = static_cast<std::size_t>(item);
  tight_[k] = tight;
  if (boxes_[k].contains(tight)) return;
  boxes_[k] = tight.grown(margin_);
  if (tree_.has(item)) mark_changed(item);
}

void BroadPhase::mark_changed(std::int32_t item) noexcept {
  // More of them than boxes mean the same as as many. `add` has made room.
  if (changed_.size() <= boxes_.size()) changed_.push_back(item);
  current_ = false;
}

std::int32_t BroadPhase::add(const Box3& tight) {
  const std::size_t items = boxes_.size() + 1;
  make_room(tight_, items);
  make_room(boxes_, items);
  make_room(free_, items);
  make_room(changed_, items + 1);
  make_room(loose_, items);
  std::int32_t item = 0;
  if (free_.empty()) {
    item = static_cast<std::int32_t>(boxes_.size());
    tight_.emplace_back();
    boxes_.emplace_back();
  } else {
    std::pop_heap(free_.begin(), free_.end(), std::greater<>());
    item = free_.back();
    free_.pop_back();
  }
  set_box(item, tight);
  if (!tree_.has(item)) {
    loose_.push_back(item);
    current_ = false;
  }
  return item;
}

void BroadPhase::remove(std::int32_t item) noexcept {
  const auto k = static_cast<std::size_t>(item);
  tight_[k] = {};
  boxes_[k] = {};
  if (tree_.has(item)) {
    mark_changed(item);
  } else {
    std::erase(loose_, item);
  }
  free_.push_back(item);
  std::push_heap(free_.begin(), free_.end(), std::greater<>());
}

void BroadPhase::move(std::int32_t item, const Box3& tight) noexcept {
  set_box(item, tight);
}

Box3 BroadPhase::bounds() const {
  const BoxTree& all = tree();
  Box3 both = all.empty() ? Box3() : all.root();
  for (const std::int32_t item : loose_) both.add(box(item));
  return both;
}

const BoxTree& BroadPhase::tree() const {
  if (!current_.load(std::memory_order_acquire)) {
    const std::lock_guard lock(mutex_);
    if (!current_.load(std::memory_order_relaxed)) {
      bring_up_to_date();
      current_.store(true, std::memory_order_release);
    }
  }
  return tree_;
}

void BroadPhase::bring_up_to_date() const {
  const std::size_t bodies = boxes_.size() - free_.size();
  // All of them are tried by every query, and all pairs of them.
  const auto many = kFewItems + static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(bodies)));
  bool build = loose_.size() > many || tree_.leaves() > 2 * bodies + kFewItems;
  if (!build && !changed_.empty()) {
    if (changed_.size() > bodies / kChangedShare) {
      tree_.refit(boxes_);
    } else {
      for (const std::int32_t item : changed_) tree_.refit(item, box(item));
    }
    build = build || !(tree_.cost() <= kWorseTree * built_cost_);
    built_cost_ = std::min(built_cost_, tree_.cost());
  }
  changed_.clear();
  if (!build) return;
  std::vector<std::int32_t> items;
  items.reserve(bodies);
  for (std::size_t k = 0; k < boxes_.size(); ++k) {
    if (!boxes_[k].empty()) items.push_back(static_cast<std::int32_t>(k));
  }
  BoxTree built;  // of its own, so that the old tree stays if there is no memory
  built.build(std::move(items), boxes_);
  tree_ = std::move(built);
  built_cost_ = tree_.cost();
  loose_.clear();
}

}  // namespace geom::scene
