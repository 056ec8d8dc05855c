#pragma once

/// Wave vectors of the box at which crystals and layers scatter.

#include "observables/structure.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace ed::internal {

/// A wave vector q is a Bragg peak if S(q) / N, 1 for bodies on planes, is at least kBraggPeak and kBraggChance / N: of
/// thousands of S(q) of one frame of a fluid the largest is up to 20 by chance.
constexpr double kBraggPeak = 0.1;
constexpr double kBraggChance = 20;

/// Returns the least S(q) / N of a Bragg peak of N bodies.
double least_bragg_peak(double number);

/// Returns the wave vectors of the box, in units of 2 pi / box, with lengths up to `largest_q`; one of n and -n. The
/// range is shortened where they would be more than kMostPerBody times the number of bodies, as in a gas, or that
/// product more than kMostPhases, as with many bodies.
std::vector<Eigen::Vector3i> allowed_vectors(double box, double largest_q, double number);
constexpr double kMostPerBody = 100;
constexpr double kMostPhases = 2e10;

/// Returns S(q) / N at each of the vectors, N the bodies of the range.
std::vector<double> intensities(const std::vector<Eigen::Vector3i>& vectors, double box,
                                const std::vector<Eigen::Vector3d>& positions, BodyRange range);

/// Returns the `most` vectors with the largest intensities, in falling order.
std::vector<Eigen::Vector3i> strongest(const std::vector<Eigen::Vector3i>& vectors, const std::vector<double>& values,
                                       std::size_t most);

}  // namespace ed::internal
