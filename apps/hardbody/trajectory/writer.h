#pragma once

#include "trajectory/frame.h"

#include <cstdint>
#include <filesystem>
#include <utility>

namespace hardbody {

/// Length of a file of frames.
struct FileMark {
  std::uint64_t frames = 0;
  std::uint64_t bytes = 0;  ///< length without a trailer; 0: there is no file
};

/// File to which frames are appended. Its content after k frames depends on these frames alone, not on how often it was
/// truncated and continued.
class FrameFile {
 public:
  explicit FrameFile(std::filesystem::path path) : path_(std::move(path)) {}
  virtual ~FrameFile() = default;
  FrameFile(const FrameFile&) = delete;
  FrameFile& operator=(const FrameFile&) = delete;

  /// Continues from `mark`: cuts off what follows. Nothing is written before the first frame. Throws
  /// std::runtime_error.
  virtual void open(FileMark mark) = 0;

  /// Appends a frame, not necessarily flushed to the disk when this returns. Throws std::runtime_error if it cannot be
  /// written; the previous content is kept.
  virtual void append(const Frame& frame) = 0;

  const std::filesystem::path& path() const { return path_; }
  FileMark mark() const { return mark_; }

 protected:
  std::filesystem::path path_;
  FileMark mark_;
};

}  // namespace hardbody
