#pragma once

/// Pairs of bodies with faces, edges and vertices whose distance is known by construction.

#include "common/geom/manufactured.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace geom_test {

/// Feature of a core that touches a tangent plane: its normal in the body's frame, and its vertices.
struct CoreFeature {
  Eigen::Vector3d n;
  std::vector<Eigen::Vector3d> vertices;
};

/// Returns a normal of a core: any direction, one across a random edge, or one of a face. A core without that feature
/// has another one.
inline Eigen::Vector3d feature_normal(const geom::kernel::CoreView& core, int kind, Random& random) {
  using geom::kernel::CoreKind;
  const Eigen::Vector3d any = random.direction();
  if (kind == 0 || core.kind == CoreKind::point) return any;
  if (core.kind == CoreKind::segment) return Eigen::Vector3d(any.x(), any.y(), 0).normalized();
  if (core.kind == CoreKind::frustum) {
    const auto& [low, high] = core.disc;
    if (kind == 2) return (high.radius > 0 && random.coin() ? 1 : -1) * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d e = Eigen::Vector3d(any.x(), any.y(), 0).normalized();
    return ((high.z - low.z) * e + (low.radius - high.radius) * Eigen::Vector3d::UnitZ()).normalized();
  }
  if (core.kind == CoreKind::box) {
    Eigen::Vector3d n = any;
    const int k = static_cast<int>(3 * random.uniform());
    if (kind == 1) n[k] = 0;
    if (kind == 2) n = std::copysign(1.0, n[k]) * Eigen::Vector3d::Unit(k);
    return n.normalized();
  }
  const auto pick = [&](std::size_t count) {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
  };
  if (kind == 2) return core.hull->normals[pick(core.hull->normals.size())];
  const geom::kernel::HullEdge& edge = core.hull->edges[pick(core.hull->edges.size())];
  const double share = random.uniform();
  const Eigen::Vector3d along =
      (core.hull->vertices.row(edge.to) - core.hull->vertices.row(edge.from)).transpose().normalized();
  const Eigen::Vector3d n = share * core.hull->normals[static_cast<std::size_t>(edge.left)] +
                            (1 - share) * core.hull->normals[static_cast<std::size_t>(edge.right)];
  return (n - n.dot(along) * along).normalized();
}

/// Returns the vertices of a core that are furthest along n, within rounding.
inline std::vector<Eigen::Vector3d> furthest_vertices(const geom::kernel::CoreView& core, const Eigen::Vector3d& n) {
  using geom::kernel::CoreKind;
  std::vector<Eigen::Vector3d> all;
  if (core.kind == CoreKind::hull) {
    for (Eigen::Index k = 0; k < core.hull->vertices.rows(); ++k) all.emplace_back(core.hull->vertices.row(k));
  } else if (core.kind == CoreKind::frustum) {
    const bool face = n.head<2>().isZero(0);
    for (const geom::kernel::CoreDisc& disc : core.disc) {
      for (int corner = 0; corner < (face ? 4 : 1); ++corner) {
        const Eigen::Vector3d e = face ? Eigen::Vector3d((corner & 1 ? 1 : -1) * (corner & 2 ? 0 : 1),
                                                         (corner & 1 ? 1 : -1) * (corner & 2 ? 1 : 0), 0)
                                       : Eigen::Vector3d(n.x(), n.y(), 0).normalized();
        all.push_back(disc.radius * e + disc.z * Eigen::Vector3d::UnitZ());
      }
    }
  } else {
    for (int corner = 0; corner < 8; ++corner) {
      all.emplace_back((corner & 1 ? 1 : -1) * core.half.x(), (corner & 2 ? 1 : -1) * core.half.y(),
                       (corner & 4 ? 1 : -1) * core.half.z());
    }
  }
  const double height = geom::kernel::core_support(core, n).height;
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Vector3d& v : all) {
    const bool is_new = std::find(result.begin(), result.end(), v) == result.end();
    if (is_new && n.dot(v) >= height - 1e-14 * core.bounding_radius) result.push_back(v);
  }
  return result;
}

/// Returns a feature of a body; smooth bodies have their support point.
template <class Shape>
CoreFeature feature_of(const Shape& shape, int kind, Random& random) {
  if constexpr (geom::CoreShape<Shape>) {
    const geom::kernel::CoreView core = shape.core();
    CoreFeature f{feature_normal(core, kind, random), {}};
    f.vertices = furthest_vertices(core, f.n);
    for (Eigen::Vector3d& v : f.vertices) v += core.radius * f.n;
    return f;
  } else {
    const Eigen::Vector3d n = random.direction();
    return {n, {shape.support(n).point}};
  }
}

/// Returns a rotation with `n` and an edge of the feature, if it has one, as first columns; else turned at random.
inline Eigen::Matrix3d frame_of(const CoreFeature& f, bool along_edge, Random& random) {
  Eigen::Vector3d t = random.direction();
  if (along_edge && f.vertices.size() >= 2) t = f.vertices[1] - f.vertices[0];
  t = (t - t.dot(f.n) * f.n).normalized();
  t = (t - t.dot(f.n) * f.n).normalized();
  Eigen::Matrix3d frame;
  frame << f.n, t, f.n.cross(t);
  return frame;
}

inline Eigen::Vector3d random_point(const CoreFeature& f, Random& random) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0;
  for (const Eigen::Vector3d& v : f.vertices) {
    const double weight = random.coin() ? random.uniform() : random.log_uniform(1e-6, 1);
    sum += weight * v;
    weights += weight;
  }
  return sum / weights;
}

/// Places B so that a feature of it, any but smooth ones turned to that of A, touches the parallel plane at `distance`
/// from A's: kinds 0, 1, 2 are vertices, edges and faces. The distance is exact for bodies apart.
template <class ShapeA, class ShapeB>
ManufacturedPair manufacture_features(const ShapeA& a, int kind_a, const ShapeB& b, int kind_b, double distance,
                                      Random& random) {
  const double radii = a.bounding_radius() + b.bounding_radius();
  const CoreFeature f_a = feature_of(a, kind_a, random);
  CoreFeature f_b = feature_of(b, kind_b, random);
  const bool aligned = random.coin();
  const geom::Pose X_WA = random.pose(radii);
  const Eigen::Matrix3d frame_a = X_WA.rotation() * frame_of(f_a, aligned, random);
  Eigen::Matrix3d turned = frame_a;  // B's normal is the opposite one, its edge the same
  turned.col(0) *= -1;
  turned.col(2) *= -1;
  const Eigen::Matrix3d R_WB = turned * frame_of(f_b, aligned, random).transpose();
  const Eigen::Vector3d n = X_WA.rotation() * f_a.n;
  const Eigen::Vector3d p_AB =
      X_WA.rotation() * random_point(f_a, random) + distance * n - R_WB * random_point(f_b, random);
  const geom::Pose X_WB(R_WB, X_WA.position() + p_AB);
  return {X_WA, X_WB, n, distance, p_AB.norm() + radii};
}

/// Returns a polyhedron of points about a sphere, the origin inside.
inline geom::ConvexPolyhedron random_polyhedron(int points, Random& random) {
  while (true) {
    std::vector<Eigen::Vector3d> all;
    for (int k = 0; k < points; ++k) all.emplace_back(random.uniform(0.7, 1) * random.direction());
    try {
      return geom::ConvexPolyhedron(all);
    } catch (const std::invalid_argument&) {  // few points may miss the origin
      continue;
    }
  }
}

}  // namespace geom_test
