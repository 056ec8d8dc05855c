#pragma once

#include <ed/export.h>
#include <ed/system.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace ed {

struct Counters;    // <ed/simulation.h>
struct FailedPair;  // <ed/simulation.h>

/// Settings of a random start.
struct StartOptions {
  int number = 512;  ///< number of bodies of a single species; mixtures: each Component's own
  double packing_fraction = 0.4;
  std::uint64_t seed = 1;
  /// Called repeatedly with the packing fraction reached; returns false to stop (the start then throws).
  std::function<bool(double packing_fraction)> progress;
  /// Order parameter S of the orientations as the bodies are placed, 0 <= S < 1; nullopt: uniform orientations. They
  /// are drawn from Maier and Saupe's distribution about z, density ~ exp(m u_z^2), with u the axis of revolution or,
  /// without one, body z. The sample's S differs by at most about 0.5 / sqrt(number), one standard error. The
  /// compression is dynamics, in which orientations relax, so that S changes until its end (at an aspect ratio of 3
  /// nothing is left of 0.8 at a packing fraction of 0.2). S is preserved only if nothing is compressed, up to a
  /// packing fraction of 0.04, less for aspect ratios above 10; otherwise see lattice_start.
  std::optional<double> nematic_order = std::nullopt;
  /// Largest number of bodies that are compressed together. The time of a compression grows with the square of the
  /// number of bodies, so larger systems are built from smaller ones: a periodic box of at most `most_compressed`
  /// bodies, in the same proportions, is compressed and then repeated along all edges, and every body gets a velocity
  /// of its own. The copies decorrelate within some collisions; at distances of a box they are correlated until bodies
  /// have diffused by their length, so large starts, too, need their equilibration.
  ///
  /// Bodies with individual sizes (components of one shape that differ only in size) are sorted by size and grouped by
  /// the number of copies. The compressed box contains the largest body of each group, and each copy holds one of the
  /// group's bodies in its place. If this or rounding would add 2 % to the number or the volume of the bodies (many
  /// species with few bodies each; few large among many small), or boxes would be too small for nearest images, starts
  /// are repeated less often or not at all: compressed_together returns how many bodies are compressed.
  ///
  /// Where sizes differ by more than a factor of 2.5, the largest bodies are inserted and compressed first, and smaller
  /// ones are inserted between them.
  int most_compressed = 1000;
  /// Numbers of bodies in consecutive groups whose temperatures are set separately; empty: the groups of the species,
  /// see rescale_velocities.
  std::vector<int> groups{};
  /// Receives the counters of the compression unless null; all 0 if nothing was compressed.
  Counters* counters = nullptr;
  /// Receives the pairs that failed in the compression unless null, as Simulation::failures; of the bodies that were
  /// compressed (masses 1; those of the box that is repeated).
  std::vector<FailedPair>* failures = nullptr;
};

/// Lattice on which the bodies are placed. Its cubic cell is stretched along the edges of the box to the proportions of
/// the bodies.
enum class Lattice {
  simple_cubic,  ///< 1 body a cell; denser than fcc for aligned superballs |x|^p + |y|^p + |z|^p <= 1 with p > 3
  fcc,           ///< 4 bodies a cell; stretched, aligned ellipsoids fill 0.7405 of space, as spheres do
};

/// Returns the enumerator's name, a single word: "cubic", "fcc".
ED_EXPORT const char* to_string(Lattice lattice);

/// Settings of a start on a lattice.
struct LatticeOptions {
  Lattice lattice = Lattice::fcc;
  double packing_fraction = 0.6;
  std::uint64_t seed = 1;
  /// Body axis (0, 1, 2) along the box's z; the two after it, cyclically, are along x and y. nullopt: the axis of
  /// revolution or, without one, body z.
  std::optional<int> axis = std::nullopt;
  /// Order parameter S = <P2(u_z)> of that axis in the start, 0 <= S < 1; nullopt: all bodies are aligned.
  std::optional<double> nematic_order = std::nullopt;
  std::vector<int> groups{};  ///< groups whose temperatures are set separately, see StartOptions
  /// Called, unless empty, once every few hundred bodies that are placed or rotated; an exception that it throws ends
  /// the start.
  std::function<void()> poll{};
};

/// Returns the largest packing fraction for which a start from a random dilute configuration is accepted: 0.02 below
/// random close packing, which is 0.64 for spheres and 0.70 for ellipsoids of revolution (Donev et al., Science 303
/// (2004) 990) and which the compression would need infinite time to reach. Other bodies pack at least as densely as
/// ellipsoids of their aspect ratio.
ED_EXPORT double densest_start(const BodyShape& shape);
/// Overload for a mixture: returns the smallest value of its components.
ED_EXPORT double densest_start(const std::vector<Component>& components);

/// Makes a start from random positions and orientations at a low packing fraction and random velocities, by the paper's
/// compression: dynamics alternates with shrinking the box by the largest factor that leaves no overlap. No two bodies
/// overlap at any moment. During the compression all masses are 1, moments of inertia in proportion; the accessible
/// configurations do not depend on them. If there are more than most_compressed bodies, a smaller box is compressed and
/// repeated.
///
/// From 4,000 bodies on, those of a species are numbered along a curve that fills the box, here and on lattices:
/// neighbours are close to each other in memory, until they have diffused (docs/decisions/022-large-systems.md).
///
/// Velocities: total momentum zero; translational kT = 1 on 3N - 3 degrees of freedom, rotational kT = 1 on 2 for a
/// body of revolution and 3 for another and, for bodies of revolution that spin, spin kT = 1 on 1. Each kind is
/// rescaled separately (at the end too, so that nearly spherical bodies, which hardly exchange energy, have the right
/// temperatures). In a mixture each species is rescaled separately (rescale_velocities): light and heavy bodies hardly
/// exchange energy either.
///
/// Throws std::invalid_argument for a packing fraction that is not positive or above densest_start, or a number below
/// smallest_number; std::runtime_error if the compression gets stuck.
ED_EXPORT System random_start(const Species& species, const StartOptions& options);

/// Overload for a mixture; the bodies are in the order of their components. Throws also for a component without bodies.
ED_EXPORT System random_start(const std::vector<Component>& components, const StartOptions& options);

/// Returns how many bodies random_start would compress together: at most most_compressed if the start is repeated, and
/// 0 if nothing needs to be compressed.
ED_EXPORT int compressed_together(const std::vector<Component>& components, const StartOptions& options);

/// Compresses an existing state to a higher packing fraction by the paper's method, from one state point to the next.
/// Velocities are rescaled at the end as those of random_start; `progress`, `counters`, `failures` and `groups` are as
/// in StartOptions.
///
/// Throws std::invalid_argument for a packing fraction below that of the state or above densest_start, and for a box
/// that would be too small (as random_start); std::runtime_error if the compression gets stuck. At the state's own
/// packing fraction only velocities change.
ED_EXPORT System compressed(const System& system, double packing_fraction,
                            const std::function<bool(double packing_fraction)>& progress = nullptr,
                            Counters* counters = nullptr, std::vector<FailedPair>* failures = nullptr,
                            const std::vector<int>& groups = {});

/// Places bodies on a lattice that fills the box, at exactly this packing fraction: dense and ordered states that no
/// compression reaches. Velocities are as in random_start; densest_start does not apply.
///
/// The cubic box is divided into nx x ny x nz stretched cells, and every site is occupied. Among all factorisations of
/// the number of bodies (a quarter of it for fcc), the one is taken in whose cells the aligned bodies could be packed
/// densest. Bodies of several species are assigned to sites at random, in cells for their r.m.s. extents.
///
/// With nematic_order the bodies then rotate about their sites, without overlap at any step, until the order has fallen
/// to S, and on without falling below. The orientations are uniform among all those without overlap and with this
/// order, which is S up to the rotation of one body (if S is near 0, up to the error of a sample). If bodies have room
/// that is Maier and Saupe's distribution.
///
/// All pairs within reach, in all images, are tested for overlap. Throws std::invalid_argument with one of these names.
/// packing_fraction: aligned bodies overlap; the message states the largest packing fraction of this number of bodies
/// on this lattice, and the nearest numbers for which the requested one is possible (for several species: body counts
/// whose lattice cells fit the mean ellipsoid). number: it is not a multiple of 4 (fcc), or the box is too small for
/// nearest images (as random_start). nematic_order: the bodies have no room to rotate that far; the message states
/// numbers whose cells fit them better. axis: it is not a body axis.
ED_EXPORT System lattice_start(const std::vector<Component>& components, const LatticeOptions& options);

/// Sets the total momentum to zero and the temperatures of each group to 1, the translational one on its own 3 (N_k -
/// M_k / M) degrees of freedom, which zero total momentum leaves it; M_k is the group's part of the total mass M.
/// `groups`: numbers of bodies in consecutive groups. Without them the bodies of a species are a group, and species of
/// one body each (a distribution of sizes) are one together. Spheres and other bodies of one group have rotational
/// temperatures of their own. Motions that are zero remain zero.
///
/// The velocities of a single group change by one factor, those of several by one factor a group, relative to the
/// group's mean velocity; mean velocities change only if a group has no other motion that could be scaled. Throws
/// std::invalid_argument for numbers that do not add up to that of the bodies.
ED_EXPORT void rescale_velocities(System& system, const std::vector<int>& groups = {});

}  // namespace ed
