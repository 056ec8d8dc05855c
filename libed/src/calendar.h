#pragma once

#include <ed/internal/archive.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace ed::internal {

/// The event calendar: the body with the earliest event, in O(log N) an update.
///
/// A tournament tree: leaf i holds the time of body i's earliest event, an inner node the smaller of its two
/// children's. Ties go to the body with the lower number.
class Calendar {
 public:
  explicit Calendar(int number) : leaves_(1), number_(static_cast<std::size_t>(number)) {
    while (leaves_ < number_) leaves_ *= 2;
    tree_.assign(2 * leaves_, std::numeric_limits<double>::infinity());
  }

  double time(int i) const { return tree_[leaves_ + static_cast<std::size_t>(i)]; }

  void set(int i, double time) {
    std::size_t node = leaves_ + static_cast<std::size_t>(i);
    tree_[node] = time;
    for (node /= 2; node >= 1; node /= 2) {
      const double left = tree_[2 * node];
      const double right = tree_[2 * node + 1];
      const double earliest = right < left ? right : left;
      // Nothing changes above a node that keeps its value.
      if (tree_[node] == earliest) break;
      tree_[node] = earliest;
    }
  }

  double earliest_time() const { return tree_[1]; }

  int earliest() const {
    std::size_t node = 1;
    while (node < leaves_) node = tree_[2 * node + 1] < tree_[2 * node] ? 2 * node + 1 : 2 * node;
    return static_cast<int>(node - leaves_);
  }

  /// The tree as it is; read into a calendar of the same number of bodies.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t size = self.tree_.size();
    archive(self.tree_);
    expect(archive, self.tree_.size() == size && self.is_tournament(), "the calendar is not in order");
  }

 private:
  bool is_tournament() const {
    for (std::size_t node = 1; node < leaves_; ++node) {
      if (tree_[node] != std::min(tree_[2 * node], tree_[2 * node + 1])) return false;
    }
    // No event belongs to a leaf without a body.
    return std::all_of(tree_.begin() + static_cast<std::ptrdiff_t>(leaves_ + number_), tree_.end(),
                       [](double time) { return time == std::numeric_limits<double>::infinity(); });
  }

  std::size_t leaves_;
  std::size_t number_;  ///< of bodies
  std::vector<double> tree_;
};

}  // namespace ed::internal
