#pragma once

#include "frame.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace hardbody {

/// A file of frames that is read.
class TrajectoryReader {
 public:
  TrajectoryReader() = default;
  virtual ~TrajectoryReader() = default;
  TrajectoryReader(const TrajectoryReader&) = delete;
  TrajectoryReader& operator=(const TrajectoryReader&) = delete;

  /// What messages call it.
  virtual const std::string& name() const = 0;
  /// Whole ones.
  virtual std::uint64_t frame_count() const = 0;
  /// Whether what follows them is left out.
  virtual bool cut_off() const = 0;
  /// Frame k < frame_count(). Throws InputError, `name: what; accepted: ..`.
  virtual Frame read(std::uint64_t k) const = 0;
};

/// What is said of a file that ends before its last frame does, or has others than ours behind ours.
inline constexpr const char* kCutOff = "; what follows them is not whole and left out";

/// A GSD file or a LAMMPS text dump, whichever it is. Throws InputError.
std::unique_ptr<TrajectoryReader> open_frames(const std::filesystem::path& path);

}  // namespace hardbody
