#pragma once

#include "base/shapes.h"
#include "trajectory/frame.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Shape as which the report draws a body.
struct ViewShape {
  Eigen::Vector3d semi_axes;                 ///< semi-axes; bounding radius of a polytope, three times
  Eigen::Vector2d exponents{1, 1};           ///< 1, 1: an ellipsoid
  std::optional<std::size_t> polytope = {};  ///< index into View::polytopes
};

/// Positions and orientations of the bodies at one time, in single precision.
struct ViewFrame {
  double time = 0;
  std::vector<float> positions;     ///< x, y, z of each body, relative to the middle of the box
  std::vector<float> orientations;  ///< w, x, y, z of each body
};

/// States of a run for the three-dimensional view.
struct View {
  double box = 0;
  std::size_t number = 0;  ///< number of bodies in the system; fewer may be shown
  std::vector<ViewShape> shapes;
  std::vector<SweptPolytope> polytopes;   ///< forms of capsules and of kinds with edges, of bounding radius 1
  std::vector<std::uint32_t> shape_of;    ///< index of the shape of each body shown
  std::vector<std::uint32_t> species_of;  ///< species of each body shown, from 0
  std::vector<ViewFrame> frames;
  std::string note;  ///< description of what is left out
};

/// Maximum number of bodies shown, and of bodies times frames: a page has to open on a telephone.
inline constexpr std::size_t kMostBodiesShown = 20'000;
inline constexpr std::size_t kMostBodyFrames = 200'000;

/// Frames that can be read one at a time.
struct FrameSource {
  std::size_t count = 0;  ///< number of frames, at least 1
  std::function<Frame(std::size_t)> read;
};

/// Returns the view of these frames. If there are too many bodies, those in a corner of the box are shown; if there are
/// too many frames, some at equal intervals, including the last one. The note says so.
View view_of(const FrameSource& source);

/// Encodes bytes by RFC 4648, with padding.
std::string base64(std::string_view bytes);

}  // namespace hardbody
