#pragma once

#include "frame_file.h"

#include <filesystem>

namespace hardbody {

/// Trajectories as LAMMPS text dumps, which OVITO and MDAnalysis read:
///
///     ITEM: ATOMS id type x y z quatw quati quatj quatk shapex shapey shapez SuperquadricRoundness.Phi
///     SuperquadricRoundness.Theta
///
/// shapex .. are the diameters along the body's axes, Phi is e2 and Theta e1. Numbers have the digits that give the
/// same double back. The time step is the frame's number; the format has no place for the time that every reader knows.
class LammpsWriter final : public FrameFile {
 public:
  explicit LammpsWriter(std::filesystem::path path) : path_(std::move(path)) {}

  void open(FileMark mark) override;
  void append(const Frame& frame) override;
  FileMark mark() const override { return mark_; }

 private:
  std::filesystem::path path_;
  FileMark mark_;
};

}  // namespace hardbody
