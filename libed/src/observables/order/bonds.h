#pragma once

/// Order of the directions from bodies to their neighbours.

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ed::internal {

/// Vectors from a body to its neighbours.
using Bonds = std::vector<Eigen::Vector3d>;

constexpr std::size_t kFewForCells = 1000;  ///< number of bodies up to which all pairs are visited
/// Radius that neighbours are collected in, over that of the sphere or disc that holds their number on average; then
/// ever larger.
constexpr double kFirstReach = 1.5;
constexpr double kLargerReach = 1.4;

/// Keeps the `number` shortest vectors, in rising order of length.
template <class Vector>
void keep_shortest(std::vector<Vector>& vectors, std::size_t number) {
  const auto kept = static_cast<std::ptrdiff_t>(std::min(number, vectors.size()));
  std::partial_sort(vectors.begin(), vectors.begin() + kept, vectors.end(),
                    [](const Vector& a, const Vector& b) { return a.squaredNorm() < b.squaredNorm(); });
  vectors.resize(static_cast<std::size_t>(kept));
}

/// Returns the vectors from body i to all others, nearest images in a cubic box.
Bonds all_bonds(const std::vector<Eigen::Vector3d>& positions, double box, std::size_t i);

/// Returns the vectors from each body to the others within `reach` < box / 4, by linked cells.
std::vector<Bonds> bonds_within(const std::vector<Eigen::Vector3d>& positions, double box, double reach);

/// Returns the vectors from each body to the `number` nearest others, nearest images in a cubic box; to all others if
/// there are fewer.
std::vector<Bonds> nearest_bonds(const std::vector<Eigen::Vector3d>& positions, double box, std::size_t number);

/// Returns Steinhardt's q_l of one body: sqrt(4 pi / (2 l + 1) sum over m of |mean of Y_lm over its bonds|^2), after
/// Steinhardt, Nelson and Ronchetti, Phys. Rev. B 28 (1983) 784. By the addition theorem it is
/// sqrt(mean over pairs of bonds of P_l of their angle).
double steinhardt(const Bonds& bonds, int l);

}  // namespace ed::internal
