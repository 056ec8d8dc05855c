#include "trajectory/frame.h"

#include <ed/observables.h>

#include <Eigen/Geometry>

#include <fmt/format.h>

#include <cstddef>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// Returns "A" to "Z", "AA", ...: names of types in other programs.
std::string letters(std::size_t k) {
  std::string name(1, static_cast<char>('A' + k % 26));
  return k < 26 ? name : letters(k / 26 - 1) + name;
}

/// Returns the body axis whose order S measures, in the world.
Vector3d axis_of(const ed::System& system, int i) {
  const int axis = ed::symmetry_axis(system.species_of(i).shape).value_or(2);
  return system.bodies[static_cast<std::size_t>(i)].rotation.col(axis);
}

}  // namespace

std::uint32_t SphereTypes::of(std::uint32_t type, double radius) {
  if (!(radius > 0)) return type;
  const auto [found, fresh] = made_.try_emplace({type, radius}, static_cast<std::uint32_t>(types_.size()));
  if (fresh) types_.push_back({types_[type].name, geom::Ellipsoid(Vector3d::Constant(radius)), true});
  return found->second;
}

Eigen::Vector4d quaternion_of(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
  return {q.w(), q.x(), q.y(), q.z()};
}

std::optional<std::string> not_a_cube(const Frame& frame) {
  const Vector3d& L = frame.box;
  if (!frame.tilt.isZero(0)) {
    return fmt::format("its box is tilted: edges {:g}, {:g}, {:g}, xy xz yz = {:g}, {:g}, {:g}", L.x(), L.y(), L.z(),
                       frame.tilt.x(), frame.tilt.y(), frame.tilt.z());
  }
  if ((L / L.x() - Vector3d::Ones()).cwiseAbs().maxCoeff() <= kSameLength) return std::nullopt;
  return fmt::format("its box has edges {:g}, {:g}, {:g}", L.x(), L.y(), L.z());
}

bool wrap(Vector3d& position, const Vector3d& box) {
  const Vector3d away = position.cwiseQuotient(box).array().round();
  if (!(away.cwiseAbs().maxCoeff() < kMostImages)) return false;
  position -= away.cwiseProduct(box);
  return true;
}

Frame frame_of(const ed::System& system, const std::vector<int>& groups) {
  Frame frame;
  frame.time = 0;
  frame.box = Vector3d::Constant(system.box);
  frame.images = frame.orientations = frame.velocities = frame.angular_velocities = frame.ids = true;
  frame.unwrapped_by = "image flags";
  frame.exact = system;
  for (const ed::Species& species : system.species) frame.types.push_back({letters(frame.types.size()), species.shape});
  std::vector<std::uint32_t> group_of;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    group_of.insert(group_of.end(), static_cast<std::size_t>(groups[k]), static_cast<std::uint32_t>(k));
  }
  std::vector<Vector3d> axes;
  for (int i = 0; i < system.size(); ++i) {
    const ed::Body& body = system.bodies[static_cast<std::size_t>(i)];
    const ed::Species& species = system.species_of(i);
    FrameBody& out = frame.bodies.emplace_back();
    out.position = out.unwrapped = body.position;
    out.rotation = body.rotation;
    out.velocity = body.velocity;
    out.angular_velocity = body.angular_velocity;
    out.mass = species.mass;
    out.inertia = species.inertia;
    out.type = static_cast<std::uint32_t>(body.species);
    out.group = group_of.at(static_cast<std::size_t>(i));
    out.id = i;
    axes.push_back(axis_of(system, i));
  }
  frame.energy = ed::kinetic_state(system).energy();
  frame.S = ed::nematic_order(axes);
  return frame;
}

Frame frame_of(const ed::Simulation& simulation, const std::vector<int>& groups, std::uint64_t number) {
  Frame frame = frame_of(simulation.system(), groups);
  ed::Snapshot snapshot;
  simulation.sample(snapshot);
  frame.step = number;
  frame.time = simulation.time();
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) frame.bodies[i].unwrapped = snapshot.position[i];
  const ed::KineticState kinetic = simulation.kinetic();
  frame.energy = kinetic.energy();
  const double n = static_cast<double>(frame.bodies.size());
  if (frame.time > 0) frame.Z = 1 + simulation.virial() / (3 * n * kinetic.translational_kT * frame.time);
  return frame;
}

}  // namespace hardbody
