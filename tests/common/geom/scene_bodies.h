#pragma once

/// Random bodies of all kinds, beside a scene of them.

#include <geom/geom.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace geom_test {

inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}
inline Eigen::Vector3d uniform3(std::mt19937_64& random, double low, double high) {
  const double x = uniform(random, low, high), y = uniform(random, low, high);
  return {x, y, uniform(random, low, high)};
}
inline geom::Pose any_pose(std::mt19937_64& random, double reach) {
  const Eigen::Vector3d v = uniform3(random, -1, 1);
  const Eigen::Vector3d p = uniform3(random, -reach, reach);
  return geom::Pose::normalized_quaternion(uniform(random, -1, 1), v.x(), v.y(), v.z(), p);
}

inline geom::Shape any_shape(std::mt19937_64& random, double size) {
  const double a = uniform(random, 0.3, 1) * size, b = uniform(random, 0.3, 1) * size;
  switch (random() % 7) {
    case 0:
      return geom::Ellipsoid({a, b, size});
    case 1:
      return geom::Superellipsoid({a, b, size}, 0.4, 0.7);
    case 2:
      return geom::Sphere(a);
    case 3:
      return geom::Capsule(a, b);
    case 4:
      return geom::Box({a, b, size});
    case 5: {
      std::vector<Eigen::Vector3d> points;
      for (int k = 0; k < 12; ++k) points.push_back(uniform3(random, -size, size));
      return geom::ConvexPolyhedron::in_principal_frame(points);
    }
    default:
      return geom::Cylinder(a, b);
  }
}

/// Bodies as they were given, beside a scene of them.
struct Bodies {
  std::vector<geom::BodyId> ids;
  std::vector<geom::Shape> shapes;
  std::vector<geom::Pose> poses;
  std::vector<geom::Filter> filters;

  void add(geom::Scene& scene, const geom::Shape& shape, const geom::Pose& pose, geom::Filter filter = {}) {
    ids.push_back(scene.add(shape, pose, filter));
    shapes.push_back(shape);
    poses.push_back(pose);
    filters.push_back(filter);
  }
  void erase(geom::Scene& scene, std::size_t k) {
    const auto at = static_cast<std::ptrdiff_t>(k);
    scene.remove(ids[k]);
    ids.erase(ids.begin() + at);
    shapes.erase(shapes.begin() + at);
    poses.erase(poses.begin() + at);
    filters.erase(filters.begin() + at);
  }
};

inline geom::Pose moved(const geom::Pose& pose, const Eigen::Vector3d& by) {
  return {pose.rotation(), pose.position() + by};
}

/// Returns all lattice vectors with numbers up to `reach`.
inline std::vector<Eigen::Vector3d> lattice_vectors(const geom::Lattice& lattice, int reach) {
  std::vector<Eigen::Vector3d> all;
  const auto most = [&](std::size_t k) { return lattice.vectors[k].isZero(0) ? 0 : reach; };
  for (int a = -most(0); a <= most(0); ++a) {
    for (int b = -most(1); b <= most(1); ++b) {
      for (int c = -most(2); c <= most(2); ++c) {
        all.emplace_back(a * lattice.vectors[0] + b * lattice.vectors[1] + c * lattice.vectors[2]);
      }
    }
  }
  return all;
}

inline Bodies many(geom::Scene& scene, std::mt19937_64& random, int count, double reach, double ratio = 1) {
  Bodies bodies;
  for (int k = 0; k < count; ++k) {
    const double size = 0.5 * std::pow(ratio, -uniform(random, 0, 1));
    bodies.add(scene, any_shape(random, size), any_pose(random, reach));
  }
  return bodies;
}

}  // namespace geom_test
