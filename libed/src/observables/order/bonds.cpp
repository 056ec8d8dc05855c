#include "observables/order/bonds.h"

#include "base/periodic.h"
#include "cells/grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

double legendre(int l, double x) {
  double before = 1;
  double value = x;
  for (int k = 2; k <= l; ++k) {
    const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
    before = value;
    value = next;
  }
  return l == 0 ? 1 : value;
}

}  // namespace

Bonds all_bonds(const std::vector<Vector3d>& positions, double box, std::size_t i) {
  Bonds bonds;
  for (std::size_t j = 0; j < positions.size(); ++j) {
    if (j != i) bonds.push_back(nearest_image(Vector3d(positions[j] - positions[i]), box));
  }
  return bonds;
}

std::vector<Bonds> bonds_within(const std::vector<Vector3d>& positions, double box, double reach) {
  const auto count = static_cast<int>(positions.size());
  CellGrid cells(count, box, reach);
  for (int i = 0; i < count; ++i) cells.place(i, positions[static_cast<std::size_t>(i)]);
  std::vector<NearBody> buffer;
  std::vector<Bonds> all(positions.size());
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    for (const NearBody& other : cells.collect(positions[at], reach, buffer)) {
      if (other.body != i && other.r.squaredNorm() < reach * reach) all[at].push_back(other.r);
    }
  }
  return all;
}

std::vector<Bonds> nearest_bonds(const std::vector<Vector3d>& positions, double box, std::size_t number) {
  std::vector<Bonds> all(positions.size());
  const auto bodies = static_cast<double>(positions.size());
  double reach = kFirstReach * box * std::cbrt(3 * static_cast<double>(number) / (4 * std::numbers::pi * bodies));
  const std::size_t wanted = std::min(number, positions.size() - 1);
  while (positions.size() > kFewForCells && reach < box / 4) {
    all = bonds_within(positions, box, reach);
    if (std::all_of(all.begin(), all.end(), [&](const Bonds& b) { return b.size() >= wanted; })) break;
    reach *= kLargerReach;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].size() < wanted) all[i] = all_bonds(positions, box, i);
    keep_shortest(all[i], number);
  }
  return all;
}

double steinhardt(const Bonds& bonds, int l) {
  if (bonds.empty()) return 0;
  double sum = static_cast<double>(bonds.size());  // P_l(1) = 1 of each with itself
  for (std::size_t a = 0; a < bonds.size(); ++a) {
    for (std::size_t b = a + 1; b < bonds.size(); ++b) {
      sum += 2 * legendre(l, bonds[a].dot(bonds[b]) / std::sqrt(bonds[a].squaredNorm() * bonds[b].squaredNorm()));
    }
  }
  return std::sqrt(std::max(0.0, sum)) / static_cast<double>(bonds.size());
}

}  // namespace ed::internal
