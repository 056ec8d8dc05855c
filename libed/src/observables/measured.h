#pragma once

/// Storage of a run's observables: blocks of sums, whose number never exceeds kMaxBlocks.

#include "base/archive.h"
#include "observables/frame_sums.h"
#include "observables/lag_sums.h"
#include "observables/structure.h"

#include <ed/archive_observables.h>
#include <ed/observables.h>

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace ed::internal {

constexpr std::size_t kMaxBlocks = 32;

/// Totals at an instant, whose differences give block averages.
struct Totals {
  double time = 0;
  double collisions = 0;
  double virial = 0;
  Eigen::Matrix3d virial_tensor = Eigen::Matrix3d::Zero();
  std::vector<double> collisions_of;  ///< collisions of the bodies of each group; empty if they are not known

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.time, self.collisions, self.virial, self.virial_tensor, self.collisions_of);
  }
};

Totals totals_of(const Simulation& simulation, const std::vector<BodyRange>& groups);

constexpr std::size_t kAll = static_cast<std::size_t>(-1);  ///< all bodies, instead of a group

/// Sums over the origins in one stretch of time.
struct Block {
  std::vector<LagSums> lags;                          ///< sums of group g at lag k: [k * groups + g]
  std::vector<FrameSums> groups;                      ///< sums of each group
  FrameSums all;                                      ///< sums of all bodies; axis_kT is left out
  Eigen::Matrix3d kinetic = Eigen::Matrix3d::Zero();  ///< kinetic_tensor, summed over frames
  Totals begin;
  Totals end;
  double frames = 0;
  int origins = 0;
  std::vector<StructureSums> structure;  ///< structure of all bodies, then, if there are several groups, of each
  double structure_frames = 0;           ///< number of frames in `structure`

  /// Returns the sums over the bodies of a group (kAll: of all).
  const FrameSums& sums_of(std::size_t group) const { return group == kAll ? all : groups[group]; }

  /// Adds the block that follows.
  void append(const Block& next);

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.lags, self.groups, self.all, self.kinetic, self.begin, self.end, self.frames, self.origins,
            self.structure, self.structure_frames);
  }
};

/// Reasons for which kinds of data are missing; nullopt for known ones. A run knows everything; stored
/// frames do not.
struct Gaps {
  using Gap = std::optional<MissingReason>;
  Gap collisions{};             ///< collisions, pressure, temperatures
  Gap displacements{};          ///< displacements and F_self
  Gap orientations{};           ///< order and g2 of single frames
  Gap turning{};                ///< C1 and C2
  Gap rotations{};              ///< angular velocities and their integrals
  Gap velocities{};             ///< velocities in single frames
  Gap velocity_correlations{};  ///< the VACF
};

/// Blocks, and the lags, groups and grids that their sums refer to.
struct Measured {
  /// Throws std::invalid_argument for options that are not usable.
  explicit Measured(const ObservablesOptions& options);

  ObservablesOptions options;
  std::vector<BodyRange> ranges;   ///< bodies of the groups
  std::vector<double> weights;     ///< fractions of all bodies that the groups have
  std::vector<double> lags;        ///< lags in rising order
  double spacing = 0;              ///< interval between origins
  int origins_per_block = 0;       ///< number of origins of a complete block
  std::vector<Freedoms> freedoms;  ///< degrees of freedom of the groups; empty before the first frame
  std::vector<Block> blocks;
  StructureGrid grid;        ///< grid of g(r) and S(q); not known() before the first frame
  bool length_known = true;  ///< whether the grid's length is that of the bodies
  int structure_every = 1;   ///< interval, in origins of a block from its first on, at which the structure is measured
  Gaps gaps{};

  /// Adds a new origin with its frame, in the last block or a new one; true if blocks have been merged by pairs
  /// first.
  bool add_origin(const Simulation& simulation, const Snapshot& now);

  /// Adds the structure of a frame to a block.
  void add_structure(const Snapshot& now, Block& block);

  /// Counts a frame in a block, and adds its order and speeds.
  void add_order(const Snapshot& now, Block& block) const;

  std::size_t structure_parts() const { return ranges.size() > 1 ? ranges.size() + 1 : 1; }

  /// Returns whether restored members are consistent with the options.
  bool fits(std::size_t number_of_lags) const;

  /// Members that follow from the options are left out, but for lags and spacing, which depend on the C library's pow.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t number_of_lags = self.lags.size();
    archive(self.freedoms, self.lags, self.spacing, self.origins_per_block, self.grid, self.blocks);
    expect(archive, self.fits(number_of_lags), "the observables do not fit together");
  }

 private:
  void make_groups();
  Block& open_block(const Simulation& simulation);
  void add_temperatures(const Simulation& simulation, Block& block);
  void merge_blocks();
  bool structure_fits(const Block& block) const;

  std::optional<WaveVectors> wave_vectors_;  ///< wave vectors of the grid; empty before their first use
};

/// Returns the wave vectors of S(q).
WaveVectors wave_vectors_of(const StructureGrid& grid);

/// Returns all results of a run with these totals. Decays are fitted from the lag `fit_from`; without it, from
/// kBallisticCollisions mean collision intervals.
Results results_of(const Measured& measured, const Totals& totals, std::optional<double> fit_from = std::nullopt);

/// Returns the first wave number of all bodies by the rule of runs (StructureResults); nullopt without structure.
std::optional<double> first_wave_number_of(const Measured& measured);

}  // namespace ed::internal
