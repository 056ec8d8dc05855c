#pragma once

/// Collective intermediate scattering function: correlations of rho(q, t), the sum of exp(i q.r) over all bodies.

#include "observables/structure.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace ed::internal {

/// Largest number of wave vectors of the box about each wave number.
constexpr int kCollectiveVectors = 48;

/// Numbers summed for each wave number: <Re rho(t) conj(rho(0))> / N and <|rho(0)|^2> / N, means over wave vectors.
constexpr std::size_t kCollectiveSums = 2;

/// Returns whether the box has wave vectors whose length differs from a wave number by at most pi / box.
bool has_wave_vectors(double box, double wave_number);

/// Adds the correlations of two frames of `number` bodies to sums, kCollectiveSums of each wave number.
void add_collective(const Amplitudes& origin, const Amplitudes& now, double number, double* sums);

}  // namespace ed::internal
