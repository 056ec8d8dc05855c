#pragma once

/// Distance of a box or a polyhedron and a smooth body that is apart.
///
/// A few steps of the algorithm of Gilbert, Johnson and Keerthi find which vertex, edge or face of the polytope is
/// closest; they converge slowly on a curved surface, but the feature stays. The distance from it is then computed
/// exactly: that of the vertex by `distance` of a point, that of an edge by the closest place on it, that of a face by
/// one support point. Two bounds tell whether the feature was the right one.

#include <geom/distance.h>
#include <geom/kernel/core.h>
#include <geom/kernel/simplex_descent.h>
#include <geom/kernel/swept_impl.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace geom::kernel {

/// Vertex, edge or three vertices of a face.
struct PolytopeFeature {
  std::array<Eigen::Vector3d, 3> vertex;
  int count = 0;

  bool operator==(const PolytopeFeature& other) const {
    if (count != other.count) return false;
    for (int k = 0; k < count; ++k) {
      if (!other.has(vertex[static_cast<std::size_t>(k)])) return false;
    }
    return true;
  }
  bool has(const Eigen::Vector3d& v) const {
    return std::any_of(vertex.begin(), vertex.begin() + count, [&](const Eigen::Vector3d& w) { return w == v; });
  }
};

/// Returns the vertices of body A that a simplex consists of.
inline PolytopeFeature feature_of(const Simplex& simplex) {
  PolytopeFeature feature;
  for (int k = 0; k < simplex.count; ++k) {
    const Eigen::Vector3d& v = simplex.point[static_cast<std::size_t>(k)].a;
    if (!feature.has(v)) feature.vertex[static_cast<std::size_t>(feature.count++)] = v;
  }
  return feature;
}

/// The search, in the frame of the polytope.
template <class Smooth>
class PolytopeAndSmooth {
 public:
  PolytopeAndSmooth(const CoreView& core, const Pose& X_WA, const Smooth& b, const Pose& X_WB)
      : core_(core),
        b_(b),
        X_AB_(unchecked_pose(X_WA.rotation().transpose() * X_WB.rotation(),
                             X_WA.rotation().transpose() * (X_WB.position() - X_WA.position()))),
        size_(X_AB_.position().norm() + core.bounding_radius + b.bounding_radius()),
        ball_(Eigen::Vector3d::Constant(std::max(1e-25 * b.inscribed_radius(), kMinSemiAxis))) {}

  /// Returns the answer in the polytope's frame; declines bodies that overlap, or whose feature is not found.
  DistanceResult solve(const Eigen::Vector3d& start) {
    constexpr int kMostSteps = 40;
    constexpr int kPatience = 6;  // steps without a closer point: the bodies overlap, or no feature is left to try
    Simplex simplex;
    Eigen::Vector3d n = start;
    PolytopeFeature last, tried;
    double shortest = std::numeric_limits<double>::infinity();
    int idle = 0;
    for (int step = 0; step < kMostSteps && idle < kPatience && best_.error_bound > kEnough * size_; ++step) {
      ++spent_;
      simplex.point[static_cast<std::size_t>(simplex.count++)] = {core_support(core_, n).point, lowest(n)};
      reduce(simplex);
      const Eigen::Vector3d closest = simplex.closest().p();
      const double length = closest.norm();
      if (!(length > 0)) break;
      idle = length < shortest ? 0 : idle + 1;
      shortest = std::min(shortest, length);
      n = closest / length;
      const PolytopeFeature feature = feature_of(simplex);
      if (feature == last && !(feature == tried)) {
        attempt_and_extend(feature, n);
        tried = feature;
      }
      last = feature;
    }
    best_.iterations = spent_;
    return best_.error_bound <= kBoundGap * size_ ? best_ : DistanceResult();
  }

 private:
  static constexpr double kEnough = 1e-14;  ///< error bound (of the size) that is not improved

  /// Returns the point of the smooth body that is lowest along n.
  Eigen::Vector3d lowest(const Eigen::Vector3d& n) const {
    return X_AB_.to_world(Support(b_.support(X_AB_.rotation().transpose() * -n)).point);
  }

  /// Takes the distance from a feature, and where a vertex beyond it is closer, that from both.
  void attempt_and_extend(PolytopeFeature feature, const Eigen::Vector3d& n) {
    const DistanceResult r = from_feature(feature, n);
    offer(r);
    if (!(r.distance > 0) || !(best_.error_bound > kEnough * size_) || feature.count == 3) return;
    const Eigen::Vector3d beyond = core_support(core_, r.normal).point;
    if (feature.has(beyond)) return;
    feature.vertex[static_cast<std::size_t>(feature.count++)] = beyond;
    offer(from_feature(feature, r.normal));
  }

  /// Returns the distance from a feature, `point_a` on it. `n`: a guess of the normal.
  DistanceResult from_feature(const PolytopeFeature& feature, const Eigen::Vector3d& n) const {
    if (feature.count == 1) return from_point(feature.vertex[0], n);
    if (feature.count == 2) return from_edge(feature.vertex[0], feature.vertex[1], n);
    return from_face(feature, n);
  }

  DistanceResult from_point(const Eigen::Vector3d& x, const Eigen::Vector3d& n) const {
    DistanceResult r =
        distance(ball_, Pose::translation(x), b_, X_AB_, {.start = n, .penetration = Penetration::local});
    r.point_a = x;
    r.distance += ball_.semi_axes()[0];
    return r;
  }

  DistanceResult from_edge(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& n) const {
    const double length = (q - p).norm();
    Eigen::Matrix3d axes;
    axes.col(2) = (q - p) / length;
    axes.col(0) = axes.col(2).unitOrthogonal();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    const Pose edge = unchecked_pose(axes, 0.5 * (p + q));
    const double radius = ball_.semi_axes()[0];
    return with_skins(capsule_distance(0.5 * length, radius, edge, b_, X_AB_, {.start = n}), -radius, 0);
  }

  DistanceResult from_face(const PolytopeFeature& feature, const Eigen::Vector3d& towards) const {
    const auto& [p, q, s] = feature.vertex;
    Eigen::Vector3d n = (q - p).cross(s - p).normalized();
    if (n.dot(towards) < 0) n = -n;
    DistanceResult r;
    r.point_b = lowest(n);
    r.distance = n.dot(r.point_b - p);
    r.point_a = r.point_b - r.distance * n;
    r.normal = n;
    r.error_bound = 0;
    r.iterations = 1;
    return is_inside(r.point_a) ? r : DistanceResult();
  }

  /// Returns whether a point is in the polytope, to rounding.
  bool is_inside(const Eigen::Vector3d& x) const {
    const double tolerance = 1e-15 * size_;
    if (core_.kind == CoreKind::box) return (x.cwiseAbs() - core_.half).maxCoeff() <= tolerance;
    for (std::size_t k = 0; k < core_.hull->normals.size(); ++k) {
      if (!(core_.hull->normals[k].dot(x) <= core_.hull->offsets[k] + tolerance)) return false;
    }
    return true;
  }

  /// Takes an answer if the plane across its normal bounds the distance from below better than before.
  void offer(const DistanceResult& r) {
    spent_ += r.iterations;
    if (!(r.distance > 0)) return;
    const double above = std::max(0.0, core_support(core_, r.normal).height - r.normal.dot(r.point_a));
    const double bound = r.error_bound + above;
    if (!(bound < best_.error_bound)) return;
    best_ = r;
    best_.distance = r.distance - above;
    best_.point_b = r.point_a + best_.distance * r.normal;
    best_.residual = (r.point_b - best_.point_b).norm();
    best_.error_bound = bound;
    best_.status = DistanceStatus::separated;
  }

  CoreView core_;
  const Smooth& b_;
  Pose X_AB_;
  double size_;
  Ellipsoid ball_;  ///< stands for a point
  int spent_ = 0;
  DistanceResult best_ = [] {
    DistanceResult none;
    none.error_bound = std::numeric_limits<double>::infinity();
    return none;
  }();
};

/// Returns the distance of a box or a hull without a ball and a smooth body; declines those that overlap, and others.
template <class Smooth>
DistanceResult polytope_to_smooth(const CoreView& core, const Pose& X_WA, const Smooth& b, const Pose& X_WB,
                                  const DistanceOptions& options) {
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const double start2 = options.start.squaredNorm();
  const bool warm = std::isfinite(start2) && start2 > 0;
  const Eigen::Vector3d first = warm ? Eigen::Vector3d(options.start / std::sqrt(start2)) : unit_or_x(r);
  PolytopeAndSmooth<Smooth> search(core, X_WA, b, X_WB);
  DistanceResult result = search.solve(X_WA.rotation().transpose() * first);
  if (result.status == DistanceStatus::not_converged) return result;
  result.normal = X_WA.rotation() * result.normal;
  result.point_a = X_WA.to_world(result.point_a);
  result.point_b = result.point_a + result.distance * result.normal;
  return result;
}

}  // namespace geom::kernel
