#pragma once

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
  explicit Calendar(int number) : leaves_(1) {
    while (leaves_ < static_cast<std::size_t>(number)) leaves_ *= 2;
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

 private:
  std::size_t leaves_;
  std::vector<double> tree_;
};

}  // namespace ed::internal
