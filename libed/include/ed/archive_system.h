#pragma once

/// @file
/// Serialisation of shapes, poses, motions and systems (archive.h).

#include <ed/archive.h>
#include <ed/motion.h>
#include <ed/system.h>

#include <geom/obb.h>
#include <geom/pose.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ed::archive {

// ---- Shapes and poses

/// Makes a unit sphere to be overwritten.
template <>
struct Blank<geom::Ellipsoid> {
  /// Makes the object.
  static geom::Ellipsoid make() { return geom::Ellipsoid(Eigen::Vector3d::Ones()); }
};
/// Makes a unit sphere to be overwritten.
template <>
struct Blank<geom::Superellipsoid> {
  /// Makes the object.
  static geom::Superellipsoid make() { return {Eigen::Vector3d::Ones(), 1, 1}; }
};
/// Makes a unit sphere to be overwritten.
template <>
struct Blank<geom::Sphere> {
  /// Makes the object.
  static geom::Sphere make() { return geom::Sphere(1); }
};
/// Makes a capsule to be overwritten.
template <>
struct Blank<geom::Capsule> {
  /// Makes the object.
  static geom::Capsule make() { return {1, 1}; }
};
/// Makes a cube to be overwritten.
template <>
struct Blank<geom::Box> {
  /// Makes the object.
  static geom::Box make() { return geom::Box(Eigen::Vector3d::Ones()); }
};
/// Makes a tetrahedron to be overwritten.
template <>
struct Blank<geom::ConvexPolyhedron> {
  /// Makes the object.
  static geom::ConvexPolyhedron make() {
    return geom::ConvexPolyhedron(std::array<Eigen::Vector3d, 4>{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}});
  }
};
/// Makes a cylinder to be overwritten.
template <>
struct Blank<geom::Cylinder> {
  /// Makes the object.
  static geom::Cylinder make() { return {1, 1}; }
};
/// Makes a cone to be overwritten.
template <>
struct Blank<geom::Cone> {
  /// Makes the object.
  static geom::Cone make() { return {1, 1}; }
};
/// Makes a rounded shape to be overwritten.
template <class Inner>
struct Blank<geom::Rounded<Inner>> {
  /// Makes the object.
  static geom::Rounded<Inner> make() { return {Blank<Inner>::make(), 0}; }
};
/// Stands for a user's shape, which is code and cannot be restored: the bytes only distinguish it from other shapes.
template <>
struct Blank<CustomShape> {
  /// Throws std::invalid_argument.
  static CustomShape make() { throw std::invalid_argument("state: a user's own shape cannot be read"); }
};

/// Writes a shape.
inline void fields(Writer& archive, const geom::Ellipsoid& shape) {
  archive(shape.semi_axes());
}
/// Reads a shape.
inline void fields(Reader& archive, geom::Ellipsoid& shape) {
  shape = geom::Ellipsoid(archive.value<Eigen::Vector3d>());
}

/// Writes a shape.
inline void fields(Writer& archive, const geom::Superellipsoid& shape) {
  archive(shape.semi_axes(), shape.e1(), shape.e2());
}
/// Reads a shape.
inline void fields(Reader& archive, geom::Superellipsoid& shape) {
  const auto semi_axes = archive.value<Eigen::Vector3d>();
  const auto e1 = archive.value<double>();
  const auto e2 = archive.value<double>();
  shape = geom::Superellipsoid(semi_axes, e1, e2);
}

/// Writes a shape.
inline void fields(Writer& archive, const geom::Sphere& shape) {
  archive(shape.radius());
}
/// Reads a shape.
inline void fields(Reader& archive, geom::Sphere& shape) {
  shape = geom::Sphere(archive.value<double>());
}

/// Writes a shape.
inline void fields(Writer& archive, const geom::Capsule& shape) {
  archive(shape.half_length(), shape.radius());
}
/// Reads a shape.
inline void fields(Reader& archive, geom::Capsule& shape) {
  const auto half_length = archive.value<double>();
  shape = geom::Capsule(half_length, archive.value<double>());
}

/// Writes a shape.
inline void fields(Writer& archive, const geom::Box& shape) {
  archive(shape.half_extents());
}
/// Reads a shape.
inline void fields(Reader& archive, geom::Box& shape) {
  shape = geom::Box(archive.value<Eigen::Vector3d>());
}

/// Writes a shape: its vertices, of which the hull is made again.
inline void fields(Writer& archive, const geom::ConvexPolyhedron& shape) {
  archive(std::int64_t{shape.vertex_count()});
  for (int k = 0; k < shape.vertex_count(); ++k) archive(shape.vertex(k));
}
/// Reads a shape; its hull has the same order of vertices, faces and edges, which depends on the vertices alone.
inline void fields(Reader& archive, geom::ConvexPolyhedron& shape) {
  std::vector<Eigen::Vector3d> vertices;
  for (auto k = archive.value<std::int64_t>(); k > 0; --k) vertices.push_back(archive.value<Eigen::Vector3d>());
  shape = geom::ConvexPolyhedron(vertices);
}

/// Writes a shape.
inline void fields(Writer& archive, const geom::Cylinder& shape) {
  archive(shape.half_length(), shape.radius());
}
/// Reads a shape.
inline void fields(Reader& archive, geom::Cylinder& shape) {
  const auto half_length = archive.value<double>();
  shape = geom::Cylinder(half_length, archive.value<double>());
}

/// Writes a shape.
inline void fields(Writer& archive, const geom::Cone& shape) {
  archive(shape.height(), shape.radius(), shape.base());
}
/// Reads a shape.
inline void fields(Reader& archive, geom::Cone& shape) {
  const auto height = archive.value<double>();
  const auto radius = archive.value<double>();
  shape = geom::Cone(height, radius, archive.value<double>());
}

/// Writes a shape.
template <class Inner>
void fields(Writer& archive, const geom::Rounded<Inner>& shape) {
  archive(shape.inner(), shape.radius());
}
/// Reads a shape.
template <class Inner>
void fields(Reader& archive, geom::Rounded<Inner>& shape) {
  auto inner = archive.value<Inner>();
  shape = geom::Rounded<Inner>(std::move(inner), archive.value<double>());
}

/// Writes the properties by which a user's shape is recognised.
inline void fields(Writer& archive, const CustomShape& shape) {
  archive(shape.name(), shape.volume(), shape.bounding_radius(), shape.inscribed_radius(), shape.symmetry_axis());
}
/// Reads nothing, see Blank<CustomShape>.
inline void fields(Reader& /*archive*/, CustomShape& /*shape*/) {}

/// Writes a pose.
inline void fields(Writer& archive, const geom::Pose& pose) {
  archive(pose.rotation(), pose.position());
}
/// Reads a pose, to the same bits.
inline void fields(Reader& archive, geom::Pose& pose) {
  const auto rotation = archive.value<Eigen::Matrix3d>();
  // Unchecked: the constructor would orthonormalise the rotation again, which changes bits.
  pose = geom::kernel::unchecked_pose(rotation, archive.value<Eigen::Vector3d>());
}

template <class Archive, Is<geom::OrientedBox> T>
void fields(Archive& archive, T& box) {
  archive(box.centre, box.axes, box.half_extents);
}

// ---- Systems

template <class Archive, Is<Species> T>
void fields(Archive& archive, T& species) {
  archive(species.shape, species.mass, species.inertia, species.spins);
}

template <class Archive, Is<Body> T>
void fields(Archive& archive, T& body) {
  archive(body.species, body.position, body.rotation, body.velocity, body.angular_velocity);
}

template <class Archive, Is<System> T>
void fields(Archive& archive, T& system) {
  archive(system.box, system.species, system.bodies);
}

template <class Archive, Is<KineticState> T>
void fields(Archive& archive, T& state) {
  archive(state.translational_energy, state.rotational_energy, state.spin_energy, state.translational_kT,
          state.rotational_kT, state.rotational_degrees_of_freedom, state.spin_degrees_of_freedom, state.axis_energy,
          state.momentum);
}

template <class Archive, Is<Motion> T>
void fields(Archive& archive, T& motion) {
  archive(motion.pose, motion.velocity, motion.angular_velocity, motion.inertia, motion.time);
}

}  // namespace ed::archive
