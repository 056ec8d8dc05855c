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

#include <stdexcept>

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
