#pragma once

/// Derivatives of a distance by differences along a motion of both bodies.

#include <geom/geom.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace geom_test {

/// Returns the pose turned by the vector `turn` (world, radian) about its position and moved by `move`.
inline geom::Pose displaced(const geom::Pose& X, const Eigen::Vector3d& move, const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  Eigen::Matrix3d R = X.rotation();
  if (angle > 0) R = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * R;
  return geom::Pose(R, X.position() + move);
}

/// Distance, normal and points, one below the other.
using Answers = Eigen::Matrix<double, 10, 1>;

inline Answers answers_of(const geom::DistanceResult& r) {
  Answers a;
  a << r.distance, r.normal, r.point_a, r.point_b;
  return a;
}

/// Derivative by central differences of sixth order, from the step that agrees best with the next larger and the next
/// smaller one; `error` is how well they do. Steps across a change of features do not agree.
template <int Rows>
struct Difference {
  Eigen::Matrix<double, Rows, 1> value;
  double error = std::numeric_limits<double>::infinity();
};

/// Derivatives of the answers, and the second one of the distance, along a motion.
struct Differences {
  Difference<1> first;
  Difference<9> others;
  Difference<1> second;
};

/// Computes the differences of `at(t)`, which returns Answers.
template <class F>
Differences differences(const F& at) {
  constexpr std::array<double, 7> kSteps = {3.2e-2, 1.6e-2, 8e-3, 4e-3, 2e-3, 1e-3, 5e-4};
  Differences best;
  std::array<Answers, kSteps.size()> first;
  std::array<double, kSteps.size()> second;
  const Answers middle = at(0.0);
  for (std::size_t k = 0; k < kSteps.size(); ++k) {
    const double h = kSteps[k];
    std::array<Answers, 3> up, down;
    for (std::size_t i = 0; i < 3; ++i) {
      const double t = static_cast<double>(i + 1) * h;
      up[i] = at(t);
      down[i] = at(-t);
    }
    first[k] = (0.75 * (up[0] - down[0]) - 0.15 * (up[1] - down[1]) + (up[2] - down[2]) / 60) / h;
    const auto sum = [&](std::size_t i) { return (up[i][0] - middle[0]) + (down[i][0] - middle[0]); };
    second[k] = (1.5 * sum(0) - 0.15 * sum(1) + sum(2) / 90) / (h * h);
  }
  const auto offer = [](auto& difference, const auto& before, const auto& value, const auto& after) {
    const double error = std::max((value - before).norm(), (value - after).norm());
    if (!(error < difference.error)) return;
    difference.error = error;
    difference.value = value;
  };
  using One = Eigen::Matrix<double, 1, 1>;
  for (std::size_t k = 1; k + 1 < kSteps.size(); ++k) {
    offer(best.first, One(first[k - 1][0]), One(first[k][0]), One(first[k + 1][0]));
    offer(best.second, One(second[k - 1]), One(second[k]), One(second[k + 1]));
    offer(best.others, first[k - 1].template tail<9>(), first[k].template tail<9>(), first[k + 1].template tail<9>());
  }
  return best;
}

}  // namespace geom_test
