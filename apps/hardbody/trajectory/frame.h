#pragma once

#include <ed/simulation.h>
#include <ed/system.h>

#include <geom/pose.h>

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {

/// Type of bodies in a trajectory.
struct FrameType {
  std::string name;
  std::optional<ed::BodyShape> shape;  ///< nullopt: not given, or a shape that is not supported
  bool shape_given = false;  ///< whether the file gives a shape that is not supported; only if `shape` is not set
  /// Frame of the shape in the frame that bodies have in the file, where these differ; bodies have been moved to it.
  std::optional<geom::Pose> X_BS = std::nullopt;
};

/// Types of a file that gives each body a radius: every radius of a type makes a type of its own.
class SphereTypes {
 public:
  explicit SphereTypes(std::vector<FrameType> types) : types_(std::move(types)) {}

  /// Returns the index of the type of spheres with this radius; for a radius that is not above 0 the type itself:
  /// points. Throws std::invalid_argument for radii that no body can have.
  std::uint32_t of(std::uint32_t type, double radius);
  std::vector<FrameType> take() { return std::move(types_); }

 private:
  std::vector<FrameType> types_;
  std::map<std::pair<std::uint32_t, double>, std::uint32_t> made_;
};

/// Body of a frame. World frame. Quantities that the file does not contain have their defaults; Frame says which are
/// known.
struct FrameBody {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< position wrapped into the box, whose middle is the origin
  /// Position that is continuous across the faces of the box, if Frame::images; else the position in the file, which
  /// may lie outside the box.
  Eigen::Vector3d unwrapped = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero();  ///< known if Frame::angular_momenta
  double mass = 1;
  Eigen::Vector3d inertia = Eigen::Vector3d::Zero();  ///< principal moments about body x, y, z; 0: not known
  std::uint32_t type = 0;                             ///< index into Frame::types
  std::uint32_t group = 0;                            ///< species of the config; for files of other programs: the type
  double id = 0;  ///< number in the file: `id` of a dump (the line, from 1, if there is none); index of GSD, from 0
};

/// Maximum number of box edges between a position and the box; beyond, the number of an image would overflow.
inline constexpr double kMostImages = 1e9;

/// Relative difference of lengths that counts as rounding to 32 bits.
inline constexpr double kSameLength = 1e-5;

/// State of all bodies at one time, as a trajectory contains it.
struct Frame {
  std::uint64_t step = 0;  ///< time step; in this program's files the frame's number
  /// Time since production began; NaN: not stored.
  double time = std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector3d box = Eigen::Vector3d::Zero();     ///< edge lengths along x, y, z
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< middle of the box, in the file's coordinates
  /// Lengths xy, xz, yz of the tilt of the second and third edge; if not 0, positions are not wrapped, and images not
  /// used.
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
  std::vector<FrameType> types;
  std::vector<FrameBody> bodies;

  // Quantities that are known for every body of this frame.
  bool images = false;              ///< positions can be unwrapped: by images, or they are stored unwrapped
  bool zero_images = false;         ///< the images of all bodies are 0, in a file of another program
  bool orientations = false;        ///< stored here, or in frame 0 according to the schema
  bool velocities = false;          ///< stored here, or in frame 0 according to the schema
  bool angular_velocities = false;  ///< stored here, or in frame 0 according to the schema
  /// Stored here, or in frame 0; for bodies whose moments of inertia only the config contains.
  bool angular_momenta = false;
  bool ids = false;  ///< the file numbers its bodies, so that they can be followed from frame to frame
  /// Source of the unwrapped positions: "image flags" or "unwrapped columns"; empty: not known.
  std::string unwrapped_by;
  /// Changes made to the file's numbers, and numbers that are not used, one line each, "about what: what".
  std::vector<std::string> notices;

  // NaN if they are not known.
  double energy = std::numeric_limits<double>::quiet_NaN();  ///< kinetic energy, kT
  /// Compressibility factor since production began; NaN in its first moment.
  double Z = std::numeric_limits<double>::quiet_NaN();
  double S = std::numeric_limits<double>::quiet_NaN();  ///< nematic order of this frame
  /// State itself, bit for bit, with its species; only in this program's trajectories.
  std::optional<ed::System> exact;
};

/// Returns the unit quaternion w, x, y, z of a rotation.
Eigen::Vector4d quaternion_of(const Eigen::Matrix3d& rotation);

/// Returns why a frame's box is not a cube, "its box is tilted: ..", "its box has edges .."; nullopt if it is one.
std::optional<std::string> not_a_cube(const Frame& frame);

/// Wraps a position, measured from the middle of the box, into the box. Returns false if it is too far away for that.
bool wrap(Eigen::Vector3d& position, const Eigen::Vector3d& box);

/// Returns a frame of the current state of the simulation. `groups`: numbers of bodies of the species of the config, in
/// their order.
Frame frame_of(const ed::Simulation& simulation, const std::vector<int>& groups, std::uint64_t number);

/// Returns a frame of a state alone.
Frame frame_of(const ed::System& system, const std::vector<int>& groups);

}  // namespace hardbody
