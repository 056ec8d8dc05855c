#pragma once

/// Free bodies to start with, and comparison with their integrated equations of motion.

#include <common/finder/ensemble.h>
#include <common/finder/top_reference.h>

#include <ed/random.h>

#include <motion/free_top.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace free_tops {

using ed::internal::FreeTop;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using finder_test::IntegratedTop;
using finder_test::log_uniform;

struct Start {
  Vector3d inertia = Vector3d::Ones();
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d omega = Vector3d::Zero();

  FreeTop top() const { return FreeTop(inertia, rotation, omega); }
};

inline double rate_scale(const Start& s) {
  return s.omega.norm();
}

/// Random::rotation keeps some 1e-14; the tests below tell 1e-15.
inline Matrix3d orthonormal(const Matrix3d& m) {
  Matrix3d R;
  R.col(2) = m.col(2).normalized();
  R.col(0) = (m.col(0) - R.col(2).dot(m.col(0)) * R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

inline Start with_rotation(ed::Random& random, const Vector3d& inertia) {
  Start s;
  s.inertia = inertia;
  s.rotation = orthonormal(random.rotation());
  // Thermal: every axis carries the same energy on average.
  s.omega = s.rotation * random.normal3().cwiseQuotient(s.inertia.cwiseSqrt());
  return s;
}

inline Start draw_spherical(ed::Random& random) {
  return with_rotation(random, Vector3d::Constant(log_uniform(random, 0.1, 10)));
}

/// Draws tops from needles to discs, about any body axis.
inline Start draw_symmetric(ed::Random& random) {
  const double perpendicular = log_uniform(random, 0.1, 10);
  Vector3d inertia = Vector3d::Constant(perpendicular);
  const int axis = static_cast<int>(3 * random.uniform());
  inertia[axis] = perpendicular * (random.uniform() < 0.5 ? 2 - log_uniform(random, 1e-12, 1.9)  //
                                                          : log_uniform(random, 1e-3, 2));
  return with_rotation(random, inertia);
}

/// Three different moments of a body: from needles and discs to near spheres, some pairs nearly equal.
inline Start draw_asymmetric(ed::Random& random) {
  const double a = random.uniform() < 0.3 ? log_uniform(random, 1e-15, 1e-3) : random.uniform();
  const double b = random.uniform() < 0.3 ? log_uniform(random, 1e-15, 1e-3) : random.uniform();
  const double c = random.uniform() < 0.3 ? log_uniform(random, 1e-4, 1e-2) : random.uniform();
  // Second moments of mass along the axes, in all orders; two near zero: a needle; one: a disc.
  Vector3d second(1, c, 0);
  second.z() = random.uniform() < 0.5 ? c * (1 + a) : 1 + a;
  second.x() += random.uniform() < 0.2 ? b * 1e-3 : b;
  const int shift = static_cast<int>(3 * random.uniform());
  const int other = random.uniform() < 0.5 ? 1 : 2;
  const Vector3d m(second[shift], second[(shift + other) % 3], second[(shift + 2 * other) % 3]);
  return with_rotation(random, log_uniform(random, 0.01, 100) * Vector3d(m.y() + m.z(), m.z() + m.x(), m.x() + m.y()));
}

/// Returns how much rounding of omega is magnified in k'^2: 1 for symmetric tops, large for asymmetric ones near the
/// separatrix.
inline double condition(const Start& s) {
  std::array<int, 3> i{0, 1, 2};
  std::sort(i.begin(), i.end(), [&](int a, int b) { return s.inertia[a] < s.inertia[b]; });
  const Vector3d w = s.rotation.transpose() * s.omega;
  const Vector3d& I = s.inertia;
  const double low = I[i[0]] * (I[i[1]] - I[i[0]]) * w[i[0]] * w[i[0]];
  const double high = I[i[2]] * (I[i[2]] - I[i[1]]) * w[i[2]] * w[i[2]];
  return low > 0 && high > 0 ? (low + high) / std::max(std::abs(high - low), 1e-16 * (low + high)) : 1;
}

inline double difference(const Matrix3d& a, const IntegratedTop::Matrix& b) {
  return static_cast<double>((a.cast<long double>() - b).cwiseAbs().maxCoeff());
}

inline double difference(const Vector3d& a, const IntegratedTop::Vector& b) {
  return static_cast<double>((a.cast<long double>() - b).norm());
}

}  // namespace free_tops
