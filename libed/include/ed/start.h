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

/// Which start is wanted.
struct StartOptions {
  int number = 512;  ///< of bodies of one species; mixtures: each Component's own
  double packing_fraction = 0.4;
  std::uint64_t seed = 1;
  /// Called now and then with the packing fraction reached; returns false to stop (the start then throws).
  std::function<bool(double packing_fraction)> progress;
  /// Order parameter S of the orientations as the bodies are placed, 0 <= S < 1; nothing: uniform. They are drawn from
  /// Maier and Saupe's distribution about z, density ~ exp(m u_z^2), of u the axis of revolution or, without one, body
  /// z; the sample's S differs by at most about 0.5 / sqrt(number), one standard error. The compression is dynamics, in
  /// which orientations relax: S at its end is another (at an aspect ratio of 3 nothing is left of 0.8 at a packing
  /// fraction of 0.2). It is that of the start only where nothing is compressed, up to a packing fraction of 0.04, less
  /// for aspect ratios above 10; else see lattice_start.
  std::optional<double> nematic_order = std::nullopt;
  /// The compression takes a time that grows with the square of the number of bodies. Larger systems than this that
  /// need it are made of smaller ones: a periodic box of at most as many bodies, in the same proportions, is compressed
  /// and then repeated along all edges, and every body gets a velocity of its own. The copies lose the memory of each
  /// other within some collisions; at distances of a box they are correlated until bodies have diffused by their
  /// length, so that large starts, too, need their equilibration. Bodies that have sizes of their own (components of
  /// one shape but for its size) are sorted by size: the largest of as many as there are copies is compressed, and each
  /// copy becomes one of them. Where that or rounding would add 2 % to the number or the volume of the bodies (many
  /// species with few bodies each; few large among many small), or boxes would be too small for nearest images, starts
  /// are repeated less often or not at all: compressed_together says how many bodies are compressed.
  int most_compressed = 1000;
  /// Numbers of bodies, one group after the other, whose temperatures are set by themselves; empty: those of the
  /// species, as rescale_velocities says.
  std::vector<int> groups{};
  /// If not null: what the compression has counted, all 0 where nothing was compressed.
  Counters* counters = nullptr;
  /// If not null: the pairs that failed in it, as Simulation::failures, of the bodies that were compressed (masses 1;
  /// those of the box that is repeated).
  std::vector<FailedPair>* failures = nullptr;
};

/// Which lattice the bodies are placed on. Its cubic cell is stretched along the edges of the box to the proportions of
/// the bodies.
enum class Lattice {
  simple_cubic,  ///< 1 body a cell; superballs are densest so up to their exponent of 4 and more
  fcc,           ///< 4 bodies a cell; stretched, aligned ellipsoids fill 0.7405 of space, as spheres do
};

/// The enumerator's name, of one word: "cubic", "fcc".
ED_EXPORT const char* to_string(Lattice lattice);

/// Which start on a lattice is wanted.
struct LatticeOptions {
  Lattice lattice = Lattice::fcc;
  double packing_fraction = 0.6;
  std::uint64_t seed = 1;
  /// Body axis (0, 1, 2) along the box's z; the two after it, cyclically, are along x and y. Nothing: the axis of
  /// revolution or, without one, body z.
  std::optional<int> axis = std::nullopt;
  /// Order parameter S = <P2(u_z)> of that axis in the start, 0 <= S < 1; nothing: all bodies are aligned.
  std::optional<double> nematic_order = std::nullopt;
  std::vector<int> groups{};  ///< whose temperatures are set by themselves, as in StartOptions
};

/// The largest packing fraction that a start from a random dilute configuration is asked to reach: 0.02 below random
/// close packing, which is 0.64 for spheres and 0.70 for ellipsoids of revolution (Donev et al., Science 303 (2004)
/// 990) and where the compression takes for ever. Other bodies pack no worse than ellipsoids of their aspect ratio.
ED_EXPORT double densest_start(const BodyShape& shape);
/// That of a mixture: the least of its components'.
ED_EXPORT double densest_start(const std::vector<Component>& components);

/// Random positions and orientations at a low packing fraction, random velocities, then the paper's compression:
/// dynamics alternates with shrinking the box by the largest factor that leaves no overlap. No two bodies overlap at
/// any moment. All masses are 1 meanwhile, moments of inertia in proportion: where bodies may be does not depend on
/// them. More than most_compressed bodies: a smaller box, repeated.
///
/// From 4,000 bodies on, those of a species are numbered along a curve that fills the box, here and on lattices:
/// neighbours stand near each other in memory, until they have diffused (docs/decisions/022-large-systems.md).
///
/// Velocities: total momentum zero; translational kT = 1 on 3N - 3 degrees of freedom, rotational kT = 1 on 2 a body of
/// revolution and 3 of another and, for bodies of revolution that spin, spin kT = 1 on 1, each rescaled separately (at
/// the end too, so that nearly spherical bodies, which hardly exchange energy, have the right temperatures). In a
/// mixture each species has them by itself (rescale_velocities): light and heavy bodies hardly exchange energy either.
///
/// Throws std::invalid_argument for a packing fraction that is not positive or above densest_start, or a number below
/// smallest_number; std::runtime_error if the compression gets stuck.
ED_EXPORT System random_start(const Species& species, const StartOptions& options);

/// The same for a mixture; the bodies stand in the order of their components. Throws also for a component without
/// bodies.
ED_EXPORT System random_start(const std::vector<Component>& components, const StartOptions& options);

/// How many bodies random_start would compress together: at most most_compressed where the start is repeated, and 0
/// where nothing needs to be compressed.
ED_EXPORT int compressed_together(const std::vector<Component>& components, const StartOptions& options);

/// The paper's compression of a state that is there already, to a higher packing fraction: from one state point to the
/// next. Velocities are rescaled at the end as those of random_start; `progress`, `counters`, `failures` and `groups`
/// are as in StartOptions.
///
/// Throws std::invalid_argument for a packing fraction below that of the state or above densest_start, and for a box
/// that would be too small (as random_start); std::runtime_error if the compression gets stuck. At the state's own
/// packing fraction only velocities change.
ED_EXPORT System compressed(const System& system, double packing_fraction,
                            const std::function<bool(double packing_fraction)>& progress = nullptr,
                            Counters* counters = nullptr, std::vector<FailedPair>* failures = nullptr,
                            const std::vector<int>& groups = {});

/// Bodies on a lattice that fills the box, at exactly this packing fraction: dense and ordered states that no
/// compression reaches. Velocities as those of random_start; densest_start does not apply.
///
/// A cubic box holds nx x ny x nz stretched cells, and every site has its body: among all ways to write the number of
/// bodies (a quarter of it, of fcc) as such a product, the one in whose cells the aligned bodies could be packed
/// densest. Bodies of several species stand on sites drawn at random, in cells for their r.m.s. extents.
///
/// With nematic_order the bodies then turn where they stand, from no overlap to no overlap, until the order has fallen
/// to S, and on without falling below: the orientations are uniform among all those without overlap and of this order,
/// which is S up to the turn of one body (where S is next to 0, up to the error of a sample). Where bodies have room
/// that is Maier and Saupe's distribution.
///
/// All pairs within reach, in all images, are asked for overlap. Throws std::invalid_argument: naming packing_fraction
/// where aligned bodies overlap, with the largest one of this number of bodies on this lattice and the nearest numbers
/// that have the one asked for (of several species, in whose cells ellipsoids of their mean extents would have room);
/// naming number where it is not a multiple of 4 (fcc) or the box is too small for nearest images (as random_start);
/// naming nematic_order where the bodies have no room to turn as far, and numbers whose cells fit them better; for an
/// axis that is none.
ED_EXPORT System lattice_start(const std::vector<Component>& components, const LatticeOptions& options);

/// Sets the total momentum to zero and the temperatures of each group to 1, the translational one on its own 3 (N_k -
/// M_k / M) degrees of freedom, M_k the group's share of all mass M: what momentum zero leaves it. `groups`: numbers of
/// bodies, one group after the other. Without them the bodies of a species are a group, and species of one body each
/// (a distribution of sizes) are one together. Spheres and other bodies of one group have rotational temperatures of
/// their own. What is at rest stays at rest. The velocities of a single group change by one factor, those of several by
/// one a group, relative to the group's mean velocity; mean velocities change only where a group has no other motion
/// that could be scaled. Throws std::invalid_argument for numbers that do not add up to that of the bodies.
ED_EXPORT void rescale_velocities(System& system, const std::vector<int>& groups = {});

}  // namespace ed
