#include "cells/levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>

namespace ed::internal {
namespace {

struct Members {
  int number = 0;
  double extent = 0;
};

}  // namespace

CellLevels::CellLevels(std::span<const double> extents, double box, double least_scale,
                       const std::optional<geom::InstructionSet>& batches) {
  const double largest = *std::max_element(extents.begin(), extents.end());
  // Bodies of a ratio that rounds to the bound of a class may be in either: that changes only what is searched.
  const auto below_largest = [&](double extent) {
    return static_cast<int>(std::floor(std::log(largest / extent) / std::log(kRatio)));
  };
  std::map<int, Members, std::greater<>> members;
  for (const double extent : extents) {
    Members& m = members[below_largest(extent)];
    ++m.number;
    m.extent = std::max(m.extent, extent);
  }
  const int number = static_cast<int>(extents.size());
  int smaller = 0;
  std::map<int, int> index;
  for (const auto& [level, m] : members) {
    const double reach = 2 * m.extent / least_scale;
    index[level] = static_cast<int>(classes_.size());
    classes_.push_back({m.extent, CellGrid(number, box, reach, batches, m.number), std::nullopt});
    smaller += m.number;
    if (smaller > m.number) classes_.back().with_smaller.emplace(number, box, reach, batches, smaller);
  }
  if (classes_.size() == 1) return;
  class_of_.reserve(extents.size());
  for (const double extent : extents) class_of_.push_back(index[below_largest(extent)]);
}

void CellLevels::use(geom::InstructionSet set) {
  for (Class& c : classes_) {
    c.alone.use(set);
    if (c.with_smaller) c.with_smaller->use(set);
  }
}

void CellLevels::place(int i, const Eigen::Vector3d& position) {
  const auto own = static_cast<std::size_t>(class_of(i));
  classes_[own].alone.place(i, position);
  for (std::size_t k = own; k < classes_.size(); ++k) {
    if (classes_[k].with_smaller) classes_[k].with_smaller->place(i, position);
  }
}

void CellLevels::scale(double factor) {
  for (Class& c : classes_) {
    c.alone.scale(factor);
    if (c.with_smaller) c.with_smaller->scale(factor);
  }
}

bool CellLevels::cover(double factor) const {
  return std::all_of(classes_.begin(), classes_.end(), [factor](const Class& c) {
    const double reach = 2 * c.extent * factor;
    return c.alone.cover(reach) && (!c.with_smaller || c.with_smaller->cover(reach));
  });
}

bool CellLevels::is_sorted() const {
  for (std::size_t i = 0; i < class_of_.size(); ++i) {
    const int body = static_cast<int>(i);
    const auto own = static_cast<std::size_t>(class_of_[i]);
    for (std::size_t k = 0; k < classes_.size(); ++k) {
      if (classes_[k].alone.holds(body) != (k == own)) return false;
      if (classes_[k].with_smaller && classes_[k].with_smaller->holds(body) != (k >= own)) return false;
    }
  }
  return true;
}

}  // namespace ed::internal
