#pragma once

#include "trajectory/writer.h"

#include <cstdint>
#include <filesystem>
#include <utility>

namespace hardbody {

/// Writer of trajectories as one VTK XML file of points, all frames as its time steps, which ParaView reads. Data of
/// each point: `shape`, the tensor that transforms a sphere of radius 1 into the ellipsoid of these semi-axes (for
/// ParaView's Tensor Glyph), `semi_axes`, `orientation` (w, x, y, z), `velocity`, `species` (of the config, from 0).
///
/// The head has room for all frames from the start, and contains the future position of each array; a frame's time is
/// filled in when its arrays are written.
class VtkWriter final : public FrameFile {
 public:
  /// Prepares a file of at most `capacity` frames. Nothing is written yet.
  VtkWriter(std::filesystem::path path, std::uint64_t capacity) : FrameFile(std::move(path)), capacity_(capacity) {}

  void open(FileMark mark) override;
  void append(const Frame& frame) override;

 private:
  std::uint64_t capacity_;
};

}  // namespace hardbody
