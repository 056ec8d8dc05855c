#pragma once

#include "trajectory/frame.h"
#include "trajectory/gsd/container.h"
#include "trajectory/reader.h"
#include "trajectory/writer.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace hardbody {

/// Trajectories as GSD files of schema `hoomd` 1.4, which HOOMD-blue, OVITO, freud and MDAnalysis read.
///
/// Positions, orientations (w, x, y, z), velocities, angular momenta and images are 32-bit numbers there. Beside them,
/// under log/, ours hold the state in the program's own doubles, from which `Frame::exact` comes back to every bit:
///
///     log/hardbody/time (last array of every frame: one without it is not whole), energy, Z, S
///     log/hardbody/box
///     log/hardbody/species             a row a type: kind (0 ellipsoid, 1 superellipsoid), semi-axes, e1, e2, mass,
///                                      moments, spins (0 or 1)
///     log/particles/hardbody/group     the species of the config
///     log/particles/hardbody/position, rotation (a row after the other), velocity, angular_velocity
///
/// What does not change is in frame 0 only, as the schema has it.

/// Reads any file of that schema, ours or not. Throws InputError, `name: what; accepted: ..`.
class GsdReader final : public TrajectoryReader {
 public:
  explicit GsdReader(const std::filesystem::path& path);
  GsdReader(std::unique_ptr<StoredBytes> bytes, std::string name);

  const std::string& name() const override { return file_.name(); }
  const std::string& application() const { return file_.application(); }
  /// Whether the frames have their state to every bit.
  bool exact() const { return exact_; }

  std::uint64_t frame_count() const override { return file_.frame_count(); }
  /// The file ends before they do, or behind frames of ours there are some without the doubles.
  bool cut_off() const override { return file_.cut_off(); }

  bool has_positions(std::uint64_t k) const override;

  /// Frame k < frame_count(). Numbers that are not finite, orientations that are none, types that there are not: all
  /// are refused; and frames of ours of which another program has changed the 32-bit numbers, but not the doubles.
  Frame read(std::uint64_t k) const override;

 private:
  GsdFile file_;
  bool exact_;
};

/// A frame shows only once it is whole.
class GsdWriter final : public FrameFile {
 public:
  /// Of `capacity` frames at most. Nothing is written yet.
  GsdWriter(std::filesystem::path path, std::uint64_t capacity);

  void open(FileMark mark) override;
  void append(const Frame& frame) override;
  FileMark mark() const override { return mark_; }

 private:
  std::filesystem::path path_;
  std::uint64_t capacity_;
  FileMark mark_;
};

}  // namespace hardbody
