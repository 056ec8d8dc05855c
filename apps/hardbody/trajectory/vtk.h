#pragma once

#include "trajectory/writer.h"

#include <cstdint>
#include <filesystem>

namespace hardbody {

/// Trajectories as one VTK XML file of points, all frames as its time steps, which ParaView reads. At each point:
/// `shape`, the tensor that makes the ellipsoid of these semi-axes of a sphere of radius 1 (for ParaView's Tensor
/// Glyph), `semi_axes`, `orientation` (w, x, y, z), `velocity`, `species` (of the config, from 0).
///
/// The head has room for all frames from the start, and says of each array where it will be; a frame's time is filled
/// in when its arrays are there.
class VtkWriter final : public FrameFile {
 public:
  /// Of `capacity` frames at most. Nothing is written yet.
  VtkWriter(std::filesystem::path path, std::uint64_t capacity);

  void open(FileMark mark) override;
  void append(const Frame& frame) override;
  FileMark mark() const override { return mark_; }

 private:
  std::filesystem::path path_;
  std::uint64_t capacity_;
  FileMark mark_;
};

}  // namespace hardbody
