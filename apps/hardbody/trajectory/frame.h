#pragma once

#include <ed/simulation.h>
#include <ed/system.h>

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {

/// A type of bodies, as a trajectory says it.
struct FrameType {
  std::string name;
  std::optional<ed::BodyShape> shape;  ///< nothing: not said, or none that can move here
  bool shape_given = false;            ///< of those without `shape`: the file has one, which is not known here
};

/// Types of a file that gives bodies a radius each: every radius of a type makes a type of its own.
class SphereTypes {
 public:
  explicit SphereTypes(std::vector<FrameType> types) : types_(std::move(types)) {}

  /// Number of the type of spheres with that radius; of a radius that is not above 0 the type itself: points. Throws
  /// std::invalid_argument for radii that no body can have.
  std::uint32_t of(std::uint32_t type, double radius);
  std::vector<FrameType> take() { return std::move(types_); }

 private:
  std::vector<FrameType> types_;
  std::map<std::pair<std::uint32_t, double>, std::uint32_t> made_;
};

/// One body of a frame. World frame. What the file does not say has the default; Frame says what is known.
struct FrameBody {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< wrapped into the box, whose middle is the origin
  /// Position that goes on across the faces of the box, where Frame::images; else the position as the file has it,
  /// which may lie outside the box.
  Eigen::Vector3d unwrapped = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero();  ///< where Frame::angular_momenta
  double mass = 1;
  Eigen::Vector3d inertia = Eigen::Vector3d::Zero();  ///< principal moments about body x, y, z; 0: not known
  std::uint32_t type = 0;                             ///< number in Frame::types
  std::uint32_t group = 0;                            ///< species of the config; that of another program: the type
  double id = 0;  ///< number in the file: `id` of a dump (the line, from 1, without); index of GSD, from 0
};

/// A coordinate within a box and so many edges of it is a position; beyond, an image's number would overflow.
inline constexpr double kMostImages = 1e9;

/// All bodies at one time: what a trajectory holds of it.
struct Frame {
  std::uint64_t step = 0;  ///< of ours: the frame's number
  /// Since production began; NaN: not stored.
  double time = std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector3d box = Eigen::Vector3d::Zero();     ///< edge lengths along x, y, z
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< of the box, in the file's coordinates
  /// Lengths xy, xz, yz by which the second and third edge lean; not 0: positions are not wrapped, and images not used.
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
  std::vector<FrameType> types;
  std::vector<FrameBody> bodies;

  // Quantities that are known, of every body of this frame.
  bool images = false;              ///< unwrapped positions: by images, or stored as such
  bool zero_images = false;         ///< the images of all bodies are 0, in a file of another program
  bool orientations = false;        ///< stored, or by the schema those of frame 0
  bool velocities = false;          ///< the same
  bool angular_velocities = false;  ///< the same
  bool angular_momenta = false;     ///< the same; for bodies whose moments of inertia only the config has
  bool ids = false;                 ///< the file numbers its bodies, so that they can be followed from frame to frame
  /// Source of the unwrapped positions: "image flags" or "unwrapped columns"; empty: not known.
  std::string unwrapped_by;
  /// Things that were done with the file's numbers or are not used, one line each, "about what: what".
  std::vector<std::string> notices;

  // NaN where they are not known.
  double energy = std::numeric_limits<double>::quiet_NaN();  ///< kinetic, kT
  double Z = std::numeric_limits<double>::quiet_NaN();       ///< since production began; of its first moment: NaN
  double S = std::numeric_limits<double>::quiet_NaN();       ///< nematic order of this frame
  /// Of our own trajectories: the state itself, to every bit, with the species that belong to it.
  std::optional<ed::System> exact;
};

/// "its box is tilted: ..", "its box has edges ..": why a frame's box is no cube; nothing if it is one.
std::optional<std::string> not_a_cube(const Frame& frame);

/// Wraps a position, measured from the middle of the box, into the box. False if it is too far away for that.
bool wrap(Eigen::Vector3d& position, const Eigen::Vector3d& box);

/// The simulation now. `groups`: how many bodies each species of the config has, one after the other.
Frame frame_of(const ed::Simulation& simulation, const std::vector<int>& groups, std::uint64_t number);

/// The frame of a state by itself.
Frame frame_of(const ed::System& system, const std::vector<int>& groups);

}  // namespace hardbody
