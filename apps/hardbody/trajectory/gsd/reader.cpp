#include "base/errors.h"
#include "base/shapes.h"
#include "io/text_file.h"
#include "trajectory/gsd/frame_reader.h"
#include "trajectory/gsd/frames.h"
#include "trajectory/gsd/schema.h"

#include <Eigen/Core>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace hardbody {
namespace {

using namespace gsd;
using Eigen::Vector3d;

/// Relative rounding of a 32-bit number.
constexpr double kSingle = 1e-6;

/// Returns the 32-bit number of a body that disagrees with the state; nullptr: none.
const char* edited(const FrameBody& body, const ed::Body& exact, const ed::Species& species, double box) {
  Vector3d away = body.position - exact.position;
  away -= box * (away / box).array().round().matrix();
  if (!(away.norm() <= kSingle * box)) return kNameTexts[kPosition];
  if (!((body.rotation - exact.rotation).norm() <= 10 * kSingle)) return kNameTexts[kOrientation];
  if (!(std::abs(body.mass - species.mass) <= kSingle * species.mass)) return kNameTexts[kMass];
  if (!((body.inertia - species.inertia).norm() <= kSingle * species.inertia.norm())) return kNameTexts[kInertia];
  if (!((body.velocity - exact.velocity).norm() <= kSingle * exact.velocity.norm())) return kNameTexts[kVelocity];
  // Along the body's axes, as it was stored: rounding of a long component says nothing about the rate about a thin
  // axis.
  const Vector3d L = species.inertia.cwiseProduct(exact.rotation.transpose() * exact.angular_velocity);
  const Vector3d stored = body.inertia.cwiseProduct(body.rotation.transpose() * body.angular_velocity);
  return (stored - L).norm() <= 10 * kSingle * L.norm() ? nullptr : kNameTexts[kAngularMomentum];
}

/// Throws if another program has changed the schema's own arrays, which it knows, but kept the doubles.
void check_unedited(const Frame& frame, const ed::System& system, const std::string& name, std::uint64_t k) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format(
        "{}: frame {}: {} differs from the double-precision value in log/, so the frame was edited; accepted: an "
        "unedited frame, or a file without the arrays of log/hardbody and log/particles/hardbody",
        name, k, what));
  };
  if (!frame.tilt.isZero(0)) refuse("configuration/box, which is tilted,");
  if (!((frame.box - Vector3d::Constant(system.box)).norm() <= 2 * kSingle * system.box)) refuse(kNameTexts[kBox]);
  for (std::size_t t = 0; t < system.species.size() && t < frame.types.size(); ++t) {
    const auto& shape = frame.types[t].shape;
    const bool same = !shape || same_shape(*shape, system.species[t].shape, kSingle, kSingle);
    if (!same) refuse(fmt::format("the shape of type {}", t));
  }
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const char* what = edited(frame.bodies[i], system.bodies[i], system.species_of(static_cast<int>(i)), system.box);
    if (what != nullptr) refuse(fmt::format("{} of body {}", what, i));
  }
}

/// Replaces the rounded numbers by those of the state.
void sharpen(Frame& frame, const ed::System& system) {
  frame.box = Vector3d::Constant(system.box);
  frame.orientations = frame.velocities = frame.angular_velocities = true;
  frame.zero_images = false;
  for (std::size_t k = 0; k < system.species.size() && k < frame.types.size(); ++k) {
    frame.types[k].shape = system.species[k].shape;
  }
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    FrameBody& body = frame.bodies[i];
    const ed::Body& exact = system.bodies[i];
    const ed::Species& species = system.species_of(static_cast<int>(i));
    for (int k = 0; k < 3; ++k) {
      const double images = std::round((body.unwrapped[k] - exact.position[k]) / system.box);
      body.unwrapped[k] = exact.position[k] + images * system.box;
    }
    body.position = exact.position;
    body.rotation = exact.rotation;
    body.velocity = exact.velocity;
    body.angular_velocity = exact.angular_velocity;
    body.mass = species.mass;
    body.inertia = species.inertia;
  }
}

}  // namespace

GsdReader::GsdReader(const std::filesystem::path& path) : GsdReader(open_stored_bytes(path), path.string()) {}

GsdReader::GsdReader(std::unique_ptr<StoredBytes> bytes, std::string name)
    : file_(std::move(bytes), std::move(name)),
      exact_(file_.has_name(kNameTexts[kTime])),
      shapes_(std::make_unique<ShapesOfFile>()) {
  if (file_.schema() != "hoomd") {
    throw InputError(
        fmt::format("{}: is of schema \"{}\"; accepted: \"hoomd\"", file_.name(), one_line(file_.schema(), 64)));
  }
  std::uint64_t whole = file_.frame_count();
  while (exact_ && whole > 0 && file_.find(whole - 1, kNameTexts[kTime]) == nullptr) --whole;
  file_.keep_frames(whole);
}

GsdReader::~GsdReader() = default;

bool GsdReader::has_positions(std::uint64_t k) const {
  if (exact_ || file_.find(k, kNameTexts[kPosition]) != nullptr) return true;
  // Positions that equal those of frame 0 are left out, if the frame has other data of the bodies.
  if (k == 0 || file_.find(0, kNameTexts[kPosition]) == nullptr || !file_.stored_later(kNameTexts[kPosition])) {
    return false;
  }
  constexpr std::array kOthers = {kOrientation, kVelocity, kAngularMomentum, kImage};
  const auto stored = [&](Name name) { return file_.find(k, kNameTexts[name]) != nullptr; };
  return std::any_of(kOthers.begin(), kOthers.end(), stored);
}

Frame GsdReader::read(std::uint64_t k) const {
  if (!has_positions(k)) {
    throw InputError(
        fmt::format("{}: frame {}: has no positions; accepted: a frame with particles/position", file_.name(), k));
  }
  FrameReader reader(file_, k, exact_, *shapes_);
  Frame frame = reader.read();
  if (!exact_) return frame;
  frame.exact = reader.read_exact();
  check_unedited(frame, *frame.exact, file_.name(), k);
  sharpen(frame, *frame.exact);
  return frame;
}

}  // namespace hardbody
