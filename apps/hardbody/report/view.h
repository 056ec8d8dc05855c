#pragma once

#include "trajectory/frame.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// What the report draws a body as.
struct ViewShape {
  Eigen::Vector3d semi_axes;
  Eigen::Vector2d exponents;  ///< 1, 1: an ellipsoid
};

/// Where the bodies are at a time, in single precision.
struct ViewFrame {
  double time = 0;
  std::vector<float> positions;     ///< x, y, z of each body, from the middle of the box
  std::vector<float> orientations;  ///< w, x, y, z
};

/// States of a run to be looked at.
struct View {
  double box = 0;
  std::size_t number = 0;  ///< of bodies in the system; fewer may be shown
  std::vector<ViewShape> shapes;
  std::vector<std::uint32_t> shape_of;    ///< of each body shown
  std::vector<std::uint32_t> species_of;  ///< of each body shown, from 0
  std::vector<ViewFrame> frames;
  std::string note;  ///< what is left out, in words
};

/// No more bodies than that are shown, and no more bodies times frames: a page has to open on a telephone.
inline constexpr std::size_t kMostBodiesShown = 20'000;
inline constexpr std::size_t kMostBodyFrames = 200'000;

/// Frames that can be read one at a time.
struct FrameSource {
  std::size_t count = 0;  ///< at least 1
  std::function<Frame(std::size_t)> read;
};

/// Of too many bodies those in a corner of the box, of too many frames some as far apart as one another, the last one
/// among them; the note says so.
View view_of(const FrameSource& source);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

}  // namespace hardbody
