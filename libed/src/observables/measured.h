#pragma once

/// Storage of a run's observables: blocks of sums, whose number never exceeds kMaxBlocks.

#include "base/archive.h"
#include "observables/collective.h"
#include "observables/frame_sums.h"
#include "observables/lag_sums.h"
#include "observables/order/phase_sums.h"
#include "observables/structure.h"

#include <ed/archive_observables.h>
#include <ed/observables.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace ed::internal {

constexpr std::size_t kMaxBlocks = 32;
/// Distance within which bodies overlap with where they were, in StructureGrid::length, a radius: 0.3 diameters, beyond
/// what bodies move in their cages.
constexpr double kOverlapReach = 0.6;
/// Bins of displacements for the van Hove function, and their width in StructureGrid::length.
constexpr std::size_t kHoveBins = 60;
constexpr double kHoveWidth = 0.1;

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
  std::vector<LagSums> lags;       ///< sums of group g at lag k: [k * groups + g]
  std::vector<double> overlap2;    ///< sums of Q^2 of all bodies at lag k
  std::vector<double> displaced;   ///< number of bodies in bin b: [(h * groups + g) * kHoveBins + b], h of hove_lags
  std::vector<double> collective;  ///< sums at lag k, wave number w: [(k * wave numbers + w) * kCollectiveSums ..]
  std::vector<FrameSums> groups;   ///< sums of each group
  FrameSums all;                   ///< sums of all bodies; axis_kT is left out
  Eigen::Matrix3d kinetic = Eigen::Matrix3d::Zero();  ///< kinetic_tensor, summed over frames
  Totals begin;
  Totals end;
  double frames = 0;
  int origins = 0;
  std::vector<StructureSums> structure;  ///< structure of each of the StructureParts
  double structure_frames = 0;           ///< number of frames in `structure` and `phase`
  PhaseSums phase;

  /// Returns the sums over the bodies of a group (kAll: of all).
  const FrameSums& sums_of(std::size_t group) const { return group == kAll ? all : groups[group]; }

  /// Adds the block that follows.
  void append(const Block& next);

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.lags, self.overlap2, self.displaced, self.collective, self.groups, self.all, self.kinetic, self.begin,
            self.end, self.frames, self.origins, self.structure, self.structure_frames, self.phase);
  }
};

/// Reasons for which kinds of data are missing; nullopt for known ones. A run knows everything; stored
/// frames do not.
struct Gaps {
  using Gap = std::optional<MissingReason>;
  Gap collisions{};             ///< collisions, pressure, temperatures
  Gap displacements{};          ///< displacements and F_self
  Gap overlap{};                ///< overlap and chi_4
  Gap orientations{};           ///< order and g2 of single frames
  Gap turning{};                ///< C1 and C2
  Gap rotations{};              ///< angular velocities and their integrals
  Gap velocities{};             ///< velocities in single frames
  Gap velocity_correlations{};  ///< the VACF

  /// Says that no body has an orientation.
  void without_orientations() { orientations = turning = rotations = MissingReason::no_orientation; }
};

/// Blocks, and the lags, groups and grids that their sums refer to.
struct Measured {
  /// Throws std::invalid_argument for options that are not usable.
  explicit Measured(const ObservablesOptions& options);

  ObservablesOptions options;
  std::vector<BodyRange> ranges;  ///< bodies of the groups
  std::vector<double> weights;    ///< fractions of all bodies that the groups have
  /// Fractions of the bodies with an orientation, 0 for the others; equal to the weights if no group has one, or all.
  std::vector<double> weights_of_rotations;
  std::vector<double> lags;            ///< lags in rising order
  std::vector<std::size_t> hove_lags;  ///< indices of the lags at which displacements are counted, rising
  double spacing = 0;                  ///< interval between origins
  int origins_per_block = 0;           ///< number of origins of a complete block
  std::vector<Freedoms> freedoms;      ///< degrees of freedom of the groups; empty before the first frame
  std::vector<Block> blocks;
  double axial_length = 0;  ///< mean length along their axes of bodies that have an orientation; 0: not known
  StructureGrid grid;       ///< grid of g(r) and S(q); not known() before the first frame
  std::vector<Eigen::Vector3i> followed;  ///< wave vectors whose intensities are measured; empty before the first frame
  bool length_known = true;               ///< whether the grid's length is that of the bodies
  int structure_every = 1;  ///< interval, in origins of a block from its first on, at which the structure is measured
  Gaps gaps{};

  /// Adds a new origin with its frame, in the last block or a new one; true if blocks have been merged by pairs
  /// first.
  bool add_origin(const Simulation& simulation, const Snapshot& now);

  /// Returns the director of a frame's bodies that have an orientation.
  Eigen::Vector3d director(const Snapshot& now) const;

  /// Correlates a frame with an earlier one, which has this director, at a lag, and adds that to a block.
  void add_lag(const Snapshot& origin, const Eigen::Vector3d& director, const Snapshot& now, std::size_t lag,
               Block& block) const;

  /// Returns the amplitudes of a frame at the wave numbers, if they are wanted.
  Amplitudes amplitudes_of(const Snapshot& frame);

  /// Correlates the amplitudes of a frame with those of an earlier one, at a lag, and adds that to a block.
  void add_collective_lag(const Amplitudes& origin, const Amplitudes& now, std::size_t lag, Block& block) const;

  /// Chooses hove_lags among the lags.
  void choose_hove_lags();

  /// Makes room in a block for all that its sums hold.
  void make_room(Block& block) const;

  /// Returns the distance that bodies move by less than to overlap with where they were.
  double overlap_length() const { return kOverlapReach * grid.length; }

  /// Adds the structure of a frame to a block.
  void add_structure(const Snapshot& now, Block& block);

  /// Counts a frame in a block, and adds its order and speeds.
  void add_order(const Snapshot& now, Block& block) const;

  StructureParts parts() const { return {ranges.size()}; }

  bool any_oriented() const {
    return std::any_of(ranges.begin(), ranges.end(), [](const BodyRange& range) { return range.oriented; });
  }

  /// Returns whether some groups have an orientation and others have none.
  bool partly_oriented() const { return weights_of_rotations != weights; }

  /// Returns whether restored members are consistent with the options.
  bool fits(std::size_t number_of_lags) const;

  /// Members that follow from the options are left out, but for lags and spacing, which depend on the C library's pow.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t number_of_lags = self.lags.size();
    archive(self.freedoms, self.lags, self.spacing, self.origins_per_block, self.axial_length, self.grid, self.followed,
            self.blocks);
    expect(archive, self.fits(number_of_lags), "the observables do not fit together");
  }

 private:
  void make_groups();
  void count_displacements(const Snapshot& origin, const Snapshot& now, std::size_t lag, Block& block) const;
  Block& open_block(const Simulation& simulation);
  void add_temperatures(const Simulation& simulation, Block& block);
  std::vector<BodyRange> phase_parts() const;
  PhaseSums phase(const Snapshot& now) const;
  void merge_blocks();
  bool structure_fits(const Block& block) const;
  std::size_t collective_size() const { return kCollectiveSums * lags.size() * options.wave_numbers.size(); }

  std::optional<WaveVectors> wave_vectors_;     ///< wave vectors of the grid; empty before their first use
  std::optional<WaveVectors> density_vectors_;  ///< wave vectors of the amplitudes; empty before their first use
};

/// Returns the wave vectors of S(q).
WaveVectors wave_vectors_of(const StructureGrid& grid);

/// Returns all results of a run with these totals. Decays are fitted from the lag `fit_from`; without it, from
/// kBallisticCollisions mean collision intervals.
Results results_of(const Measured& measured, const Totals& totals, std::optional<double> fit_from = std::nullopt);

/// Returns the first wave number of all bodies by the rule of runs (StructureResults); nullopt without structure.
std::optional<double> first_wave_number_of(const Measured& measured);

}  // namespace ed::internal
