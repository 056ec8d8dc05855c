#pragma once

#include "frame_file.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

/// Reads dumps of our own and of LAMMPS: columns id, type, x y z (or xu yu zu, xs ys zs), quatw quati quatj quatk,
/// shapex shapey shapez, SuperquadricRoundness.Phi .Theta, mass, vx vy vz, in any order; all but the positions may be
/// missing, others are skipped. Throws InputError, `name: what; accepted: ..`.
class LammpsReader {
 public:
  explicit LammpsReader(const std::filesystem::path& path);
  LammpsReader(std::string text, std::string name);
  LammpsReader(const LammpsReader&) = delete;
  LammpsReader& operator=(const LammpsReader&) = delete;

  /// Whole ones.
  std::uint64_t frame_count() const { return frames_.size(); }
  /// Whether a last one was cut off and is left out.
  bool cut_off() const { return cut_off_; }

  /// Frame k < frame_count(), the bodies in the order of their ids. Types are what type and shape make different,
  /// groups what type alone does.
  Frame read(std::uint64_t k) const;

 private:
  std::string name_;
  std::string text_;
  std::vector<std::string_view> frames_;  ///< of text_
  bool cut_off_ = false;
};

}  // namespace hardbody
