#pragma once

#include "trajectory/frame.h"
#include "trajectory/gsd/container.h"
#include "trajectory/reader.h"
#include "trajectory/writer.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

namespace hardbody {

/// Trajectories as GSD files of schema `hoomd` 1.4, which HOOMD-blue, OVITO, freud and MDAnalysis read.
///
/// The schema stores positions, orientations (w, x, y, z), velocities, angular momenta and images as 32-bit numbers.
/// This program adds, under log/, the state in its own doubles, from which `Frame::exact` is restored bit for bit:
///
///     log/hardbody/time (last array of every frame: one without it is incomplete), energy, Z, S
///     log/hardbody/box
///     log/hardbody/species             a row a type: kind (ShapeKind), lengths (ShapeNumbers), e1 and e2 or rounding
///                                      and number of vertices, mass, moments, spins (0 or 1); x, y, z of each vertex
///                                      where a type is a polyhedron, filled up with 0
///     log/particles/hardbody/group     the species of the config
///     log/particles/hardbody/position, rotation (a row after the other), velocity, angular_velocity
///
/// Constant quantities are in frame 0 only, as the schema prescribes.

struct ShapesOfFile;

/// Reads any file of this schema, written by this program or another. Throws InputError, `name: what; accepted: ..`.
class GsdReader final : public TrajectoryReader {
 public:
  explicit GsdReader(const std::filesystem::path& path);
  GsdReader(std::unique_ptr<StoredBytes> bytes, std::string name);
  ~GsdReader() override;

  const std::string& name() const override { return file_.name(); }
  const std::string& application() const { return file_.application(); }
  /// Returns whether the frames contain their state bit for bit.
  bool exact() const { return exact_; }

  std::uint64_t frame_count() const override { return file_.frame_count(); }
  /// Returns whether the file ends before its frames do, or this program's frames are followed by some without the
  /// doubles.
  bool cut_off() const override { return file_.cut_off(); }

  bool has_positions(std::uint64_t k) const override;

  /// Reads frame k < frame_count(). Refuses numbers that are not finite, invalid orientations and unknown types; also
  /// frames of this program in which another program has changed the 32-bit numbers, but not the doubles.
  Frame read(std::uint64_t k) const override;

 private:
  GsdFile file_;
  bool exact_;
  std::unique_ptr<ShapesOfFile> shapes_;
};

/// Writes frames so that each becomes visible to readers only once it is complete.
class GsdWriter final : public FrameFile {
 public:
  /// Prepares a file of at most `capacity` frames. Nothing is written yet.
  GsdWriter(std::filesystem::path path, std::uint64_t capacity) : FrameFile(std::move(path)), capacity_(capacity) {}

  void open(FileMark mark) override;
  void append(const Frame& frame) override;

 private:
  std::uint64_t capacity_;
};

}  // namespace hardbody
