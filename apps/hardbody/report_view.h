#pragma once

#include <ed/system.h>

#include <Eigen/Core>

#include <cstdint>
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
  int number = 0;  ///< of bodies in the system; fewer may be shown
  std::vector<ViewShape> shapes;
  std::vector<std::uint32_t> shape_of;    ///< of each body shown
  std::vector<std::uint32_t> species_of;  ///< of each body shown, from 0
  std::vector<ViewFrame> frames;
  std::string source;  ///< file that it was read from
  std::string note;    ///< what is left out, in words
};

/// No more bodies than that are shown, and no more bodies times frames: a page has to open on a telephone.
inline constexpr int kMostBodiesShown = 20'000;
inline constexpr int kMostBodyFrames = 200'000;

/// Of one state. `numbers`: of the bodies of each species, which stand one after the other.
View view_of(const ed::System& system, const std::vector<int>& numbers, double time);

/// Leaves out bodies, all but those in a corner of the box, and frames, all but some as far apart as one another, that
/// are too many; says so in the note.
void thin_out(View& view);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

}  // namespace hardbody
