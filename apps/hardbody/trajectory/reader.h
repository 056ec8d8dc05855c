#pragma once

#include "trajectory/frame.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
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
  /// Whether frame k has positions. GSD files may hold frames of logged values only, which are no states.
  virtual bool has_positions(std::uint64_t /*k*/) const { return true; }
  /// Whether positions may lie a little outside the box until the program that writes such files wraps them.
  virtual bool wraps_late() const { return false; }
  /// Frame k < frame_count(). Throws InputError, `name: what; accepted: ..`, also of a frame without positions.
  virtual Frame read(std::uint64_t k) const = 0;
};

/// What is said of a file that ends before its last frame does, or has others than ours behind ours.
inline constexpr const char* kCutOff = "; what follows them is not whole and left out";

/// The last frame that has positions; nothing if there is none.
std::optional<std::uint64_t> last_frame(const TrajectoryReader& reader);

/// A GSD file or a LAMMPS text dump, as its first bytes say. Throws InputError, which names the format of other files.
std::unique_ptr<TrajectoryReader> open_frames(const std::filesystem::path& path);

}  // namespace hardbody
