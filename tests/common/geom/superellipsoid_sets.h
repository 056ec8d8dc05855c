#pragma once

/// Pairs of superellipsoids in five kinds of relative orientation, three of them where flat faces, edges and
/// vertices make a distance hard.

#include "common/geom/random.h"

#include <geom/geom.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstddef>

namespace geom_test {

inline constexpr std::array kExponents{0.2, 0.3, 0.5, 0.7, 1.0, 1.3, 1.6};

inline double any_exponent(Random& random) {
  return kExponents[static_cast<std::size_t>(random.uniform() * kExponents.size())];
}

enum class PairSet { random_normal, random_point, aligned, edges, faces };

inline Eigen::Vector3d surface_point(const geom::Superellipsoid& shape, const Eigen::Vector3d& direction) {
  return direction / std::sqrt(1 + shape.value(direction));
}

inline Eigen::Vector3d small_turn(const Eigen::Vector3d& v, Random& random) {
  return (v + random.log_uniform(1e-6, 0.1) * random.direction()).normalized();
}

/// Returns a point near the middle of an edge, or near a vertex.
inline Eigen::Vector3d edge_point(const geom::Superellipsoid& shape, Random& random) {
  Eigen::Vector3d v =
      random.coin() ? Eigen::Vector3d(1, 1, 0) : (random.coin() ? Eigen::Vector3d(1, 0, 1) : Eigen::Vector3d(1, 1, 1));
  for (int k = 0; k < 3; ++k) v[k] = random.coin() ? v[k] : -v[k];
  return surface_point(shape, small_turn(v.normalized(), random));
}

/// Orientations of two bodies, and the normal between them.
struct Orientation {
  Eigen::Matrix3d R_a, R_b;
  Eigen::Vector3d n;
};

inline Orientation choose(PairSet set, const geom::Superellipsoid& a, const geom::Superellipsoid& b, Random& random) {
  Orientation o{random.pose(0).rotation(), random.pose(0).rotation(), random.direction()};
  const auto normal_at = [](const geom::Superellipsoid& shape, const Eigen::Vector3d& x) {
    return Eigen::Vector3d(shape.gradient(x).normalized());
  };
  // Turns B so that its normal m (body frame) faces n.
  const auto face = [&](const Eigen::Vector3d& m) {
    o.R_b = Eigen::Quaterniond::FromTwoVectors(o.R_b * m, -o.n).toRotationMatrix() * o.R_b;
  };
  switch (set) {
    case PairSet::random_normal:
      break;
    case PairSet::random_point:
      o.n = o.R_a * normal_at(a, surface_point(a, random.direction()));
      break;
    case PairSet::aligned:
      o.n = o.R_a * normal_at(a, surface_point(a, random.direction()));
      o.R_b = Eigen::AngleAxisd(random.log_uniform(1e-6, 0.1), random.direction()).toRotationMatrix() * o.R_a;
      break;
    case PairSet::edges:
      o.n = o.R_a * normal_at(a, edge_point(a, random));
      face(normal_at(b, edge_point(b, random)));
      break;
    case PairSet::faces: {
      const int k = static_cast<int>(3 * random.uniform());
      o.n = o.R_a * small_turn(Eigen::Vector3d::Unit(k), random);
      face(small_turn(Eigen::Vector3d::Unit((k + 1) % 3), random));
      break;
    }
  }
  return o;
}

/// Returns the pose of B with the support points of `n` `gap` apart along it: the distance, to rounding, for gap >= 0.
inline void place(const Orientation& o, const geom::Superellipsoid& a, const geom::Superellipsoid& b, double gap,
                  geom::Pose& X_WA, geom::Pose& X_WB) {
  const Eigen::Vector3d s_a = o.R_a * a.support(o.R_a.transpose() * o.n).point;
  const Eigen::Vector3d s_b = o.R_b * b.support(o.R_b.transpose() * -o.n).point;
  X_WA = geom::Pose(o.R_a, Eigen::Vector3d::Zero());
  X_WB = geom::Pose(o.R_b, s_a - s_b + gap * o.n);
}

/// Overload for two equal bodies.
/// @{
inline Orientation choose(PairSet set, const geom::Superellipsoid& shape, Random& random) {
  return choose(set, shape, shape, random);
}
inline void place(const Orientation& o, const geom::Superellipsoid& shape, double gap, geom::Pose& X_WA,
                  geom::Pose& X_WB) {
  place(o, shape, shape, gap, X_WA, X_WB);
}
/// @}

/// Returns the distance of p_W from the surface, to first order.
inline double off_surface(const geom::Superellipsoid& shape, const geom::Pose& X_WB, const Eigen::Vector3d& p_W) {
  const Eigen::Vector3d x = X_WB.to_body(p_W);
  const double N = shape.norm(x);
  return std::abs(N - 1) * 2 * N / shape.gradient(x).norm();
}

}  // namespace geom_test
