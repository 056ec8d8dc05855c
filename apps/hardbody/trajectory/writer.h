#pragma once

#include "trajectory/frame.h"

#include <cstdint>

namespace hardbody {

/// How far a file of frames goes.
struct FileMark {
  std::uint64_t frames = 0;
  std::uint64_t bytes = 0;  ///< without what only ends the file; 0: there is none
};

/// A file to which one frame after the other is appended. What it holds after so many frames depends on them alone,
/// not on how often it was cut back and gone on with.
class FrameFile {
 public:
  FrameFile() = default;
  virtual ~FrameFile() = default;
  FrameFile(const FrameFile&) = delete;
  FrameFile& operator=(const FrameFile&) = delete;

  /// Goes on from `mark`: cuts off what follows. Before the first frame nothing is written. Throws std::runtime_error.
  virtual void open(FileMark mark) = 0;

  /// Not always on the disk when this returns. Throws std::runtime_error if it cannot be written; what was there is
  /// kept.
  virtual void append(const Frame& frame) = 0;

  virtual FileMark mark() const = 0;
};

}  // namespace hardbody
