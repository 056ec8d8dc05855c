#pragma once

/// Linear systems of a few unknowns.
///
/// Eigen's solvers are avoided: an object whose fixed size is a multiple of 16 bytes, such as its 4x4 and 8x8 matrices
/// and their decompositions, is aligned according to -march. A program may be compiled with another -march than the
/// library, and the linker keeps one copy of an inline function that both contain: functions on such objects must not
/// be shared. The types here have the same layout for all.

#include <Eigen/Core>

#include <cmath>
#include <utility>

namespace geom::kernel {

template <int N>
using SmallVector = Eigen::Matrix<double, N, 1, Eigen::DontAlign>;
template <int N>
using SmallMatrix = Eigen::Matrix<double, N, N, Eigen::DontAlign>;

/// Returns x with A x = b, by Gaussian elimination with partial pivoting; infinite or NaN if A is singular.
template <int N>
SmallVector<N> solve_small(SmallMatrix<N> A, SmallVector<N> b) {
  for (int k = 0; k < N; ++k) {
    int pivot = k;
    for (int i = k + 1; i < N; ++i) {
      if (std::abs(A(i, k)) > std::abs(A(pivot, k))) pivot = i;
    }
    if (pivot != k) {
      A.row(k).swap(A.row(pivot));
      std::swap(b[k], b[pivot]);
    }
    for (int i = k + 1; i < N; ++i) {
      const double factor = A(i, k) / A(k, k);
      for (int j = k + 1; j < N; ++j) A(i, j) -= factor * A(k, j);
      b[i] -= factor * b[k];
    }
  }
  for (int k = N - 1; k >= 0; --k) {
    for (int j = k + 1; j < N; ++j) b[k] -= A(k, j) * b[j];
    b[k] /= A(k, k);
  }
  return b;
}

}  // namespace geom::kernel
