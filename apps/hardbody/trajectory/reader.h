#pragma once

#include "trajectory/frame.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace hardbody {

/// Reader of a file of frames.
class TrajectoryReader {
 public:
  TrajectoryReader() = default;
  virtual ~TrajectoryReader() = default;
  TrajectoryReader(const TrajectoryReader&) = delete;
  TrajectoryReader& operator=(const TrajectoryReader&) = delete;

  /// Returns the name of the file in messages.
  virtual const std::string& name() const = 0;
  /// Returns the number of complete frames.
  virtual std::uint64_t frame_count() const = 0;
  /// Returns whether data after them is left out.
  virtual bool cut_off() const = 0;
  /// Returns whether frame k has positions. GSD files may contain frames of logged values only, which are not states.
  virtual bool has_positions(std::uint64_t /*k*/) const { return true; }
  /// Returns whether positions may be slightly outside the box until the program that writes such files wraps them.
  virtual bool wraps_late() const { return false; }
  /// Reads frame k < frame_count(). Throws InputError, `name: what; accepted: ..`, also for a frame without positions.
  virtual Frame read(std::uint64_t k) const = 0;
};

/// Text about a file that ends before its last frame does, or in which this program's frames are followed by others.
inline constexpr const char* kCutOff = "; data after them is incomplete and left out";

/// Returns the last frame that has positions; nullopt if there is none.
std::optional<std::uint64_t> last_frame(const TrajectoryReader& reader);

/// Opens a GSD file or a LAMMPS text dump, distinguished by their first bytes. Throws InputError, which names the
/// format of other files.
std::unique_ptr<TrajectoryReader> open_frames(const std::filesystem::path& path);

}  // namespace hardbody
