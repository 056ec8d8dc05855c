#pragma once

#include "io/stored_bytes.h"
#include "trajectory/reader.h"
#include "trajectory/writer.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hardbody {

/// Writer of trajectories as LAMMPS text dumps, which OVITO and MDAnalysis read:
///
///     ITEM: ATOMS id type x y z quatw quati quatj quatk shapex shapey shapez SuperquadricRoundness.Phi
///     SuperquadricRoundness.Theta
///
/// shapex .. are the diameters along the body's axes, Phi is e2 and Theta e1. Numbers have as many digits as the same
/// double needs to be read back. The time step is the frame's number; the format has no field for the time that every
/// reader supports.
class LammpsWriter final : public FrameFile {
 public:
  using FrameFile::FrameFile;

  void open(FileMark mark) override;
  void append(const Frame& frame) override;
};

/// Reads dumps of this program and of LAMMPS: columns id, type, x y z (or xu yu zu, xs ys zs), quatw quati quatj quatk,
/// shapex shapey shapez, SuperquadricRoundness.Phi .Theta, mass, vx vy vz, in any order; all but the positions are
/// optional, others are skipped. At most one frame of the file is in memory at a time. Throws InputError, `name: what;
/// accepted: ..`.
class LammpsReader final : public TrajectoryReader {
 public:
  LammpsReader(std::unique_ptr<StoredBytes> bytes, std::string name);

  const std::string& name() const override { return name_; }
  std::uint64_t frame_count() const override { return frames_.size(); }
  bool cut_off() const override { return cut_off_; }
  bool wraps_late() const override { return true; }

  /// Reads a frame. The bodies are in the order of their ids. Each combination of type and shape is a type of the
  /// frame; each type of the file is a group.
  Frame read(std::uint64_t k) const override;

 private:
  /// Position of a frame's text in the file.
  struct Place {
    std::uint64_t begin, end;
  };
  std::vector<Place> find_frames() const;
  bool is_whole(Place frame) const;

  std::unique_ptr<StoredBytes> bytes_;
  std::string name_;
  std::vector<Place> frames_;
  bool cut_off_ = false;
};

}  // namespace hardbody
