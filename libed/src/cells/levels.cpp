#include "cells/levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>

namespace ed::internal {
namespace {

/// Ratio of the largest to the least extent of a class.
constexpr double kRatio = 2.5;

}  // namespace

std::vector<int> size_classes(std::span<const double> extents) {
  const double largest = *std::max_element(extents.begin(), extents.end());
  // Extents of a ratio that rounds to the bound of a class may be in either: that changes only what is searched.
  const auto below_largest = [&](double extent) {
    return static_cast<int>(std::floor(std::log(largest / extent) / std::log(kRatio)));
  };
  std::map<int, int, std::greater<>> numbers;
  for (const double extent : extents) numbers[below_largest(extent)] = 0;
  int next = 0;
  for (auto& [level, number] : numbers) number = next++;
  std::vector<int> classes;
  classes.reserve(extents.size());
  for (const double extent : extents) classes.push_back(numbers[below_largest(extent)]);
  return classes;
}

CellLevels::CellLevels(std::span<const double> extents, double box, double least_scale,
                       const std::optional<geom::InstructionSet>& batches)
    : class_of_(size_classes(extents)) {
  const auto classes = static_cast<std::size_t>(*std::max_element(class_of_.begin(), class_of_.end())) + 1;
  std::vector<int> members(classes, 0);
  std::vector<double> largest(classes, 0);
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const auto c = static_cast<std::size_t>(class_of_[i]);
    ++members[c];
    largest[c] = std::max(largest[c], extents[i]);
  }
  const int number = static_cast<int>(extents.size());
  int smaller = 0;
  classes_.reserve(classes);
  for (std::size_t c = 0; c < classes; ++c) {
    const double reach = 2 * largest[c] / least_scale;
    classes_.push_back({largest[c], CellGrid(number, box, reach, batches, members[c]), std::nullopt});
    smaller += members[c];
    if (c > 0) classes_.back().with_smaller.emplace(number, box, reach, batches, smaller);
  }
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
