#pragma once

#include <ed/contact_options.h>
#include <ed/export.h>
#include <ed/motion.h>
#include <ed/system.h>

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace ed {

/// What the run loop counted since its construction.
struct Counters {
  std::uint64_t collisions = 0;
  std::uint64_t predictions = 0;   ///< contact searches started, refinements included
  std::uint64_t evaluations = 0;   ///< points in time at which a pair was looked at
  std::uint64_t kernel_calls = 0;  ///< evaluations of the gap function along one normal
  /// Evaluations after a prediction's first: what its lower bound had to be refined by when it came up. The final
  /// Newton on a contact (2 evaluations a collision) is not counted here.
  std::uint64_t refinements = 0;
  std::uint64_t cold_restarts = 0;  ///< warm normals that led to a spurious maximum
  /// Certified: searches that needed the fallback which cannot fail. Bracketing: distances that Newton's method
  /// declined and the dual answered.
  std::uint64_t rescues = 0;
  std::uint64_t neighbour_rebuilds = 0;  ///< envelopes renewed
  std::uint64_t envelope_checks = 0;     ///< looks at whether a body leaves its envelope
  std::uint64_t candidate_tests = 0;     ///< pairs of envelopes tested in rebuilds
  /// Times a pair was found deeper than 1e-12 of its size: always 0 in a sound run. With Finder::bracketing not the
  /// number of contacts missed: one shows only if the bodies are still that deep when they are looked at again, and
  /// then at each look.
  std::uint64_t overlaps = 0;
  /// Contacts at which the bodies did not approach: no impulse, not a collision. Always 0 in a sound run.
  std::uint64_t parting_contacts = 0;
  std::uint64_t unrecorded_failures = 0;  ///< failed pairs beyond those that failures() has room for
};

/// Two bodies that collided.
struct Collision {
  double time;  ///< since the simulation's start
  int i;
  int j;
};

/// Why a pair could not be predicted as it should.
enum class FailureReason {
  overlap,   ///< the bodies overlap by more than rounding
  distance,  ///< Newton's method for a distance gave no answer
};

/// The enumerator's name.
ED_EXPORT const char* to_string(FailureReason reason);

/// A pair that could not be predicted as it should, at the moment where that failed, with all that is needed to look at
/// it again.
struct FailedPair {
  FailureReason reason = FailureReason::overlap;
  geom::Ellipsoid shape_i{Eigen::Vector3d::Ones()};
  geom::Ellipsoid shape_j{Eigen::Vector3d::Ones()};
  Motion motion_i;
  Motion motion_j;  ///< in the image nearest to i
  double time = 0;  ///< simulated time
  int i = 0;
  int j = 1;
  Finder finder = Finder::certified;
  double eps_d = 0;                        ///< of Finder::bracketing
  std::optional<FailedDistance> distance;  ///< what gave no answer, if that is the reason
};

/// All bodies at one time, as the observables want them.
struct Snapshot {
  double time = 0;
  std::vector<Eigen::Vector3d> position;  ///< unwrapped: continuous across the box's faces
  std::vector<Eigen::Vector3d> axis;      ///< of revolution, unit
  std::vector<Eigen::Vector3d> phi_lab;   ///< integral of omega (spin excluded), world frame, since the start
  std::vector<Eigen::Vector2d> phi_body;  ///< the same, components along body x and y
};

/// How a simulation finds neighbours and contacts.
struct SimulationOptions {
  /// Thickness of the neighbour-list envelopes (length); 0: a first guess, which `tune_envelopes` improves.
  double envelope = 0;
  Neighbours neighbours = Neighbours::dilated;
  ContactOptions contact{};
};

/// The kind of neighbour list that bench_engine shows to be the fastest: cells for dilute bodies that are not spheres,
/// where a body would leave a dilated envelope ever again between two collisions, else dilated.
ED_EXPORT Neighbours fastest_neighbours(const geom::Ellipsoid& shape, int number, double packing_fraction,
                                        Finder finder = Finder::certified);

/// Event-driven dynamics of hard ellipsoids of revolution in a periodic cubic box.
///
/// Asynchronous: each body carries its own time. Neighbour lists with dilated envelopes; one calendar entry a body; a
/// pair is looked at once after a collision and its certified lower bound put into the calendar, to be refined only
/// when it comes up (with Finder::bracketing each search is carried to its end at once). Both the finder and the
/// neighbour lists can be the paper's; the collisions are the same. Nothing allocates in steady state. The same system
/// and options give the same bits from one binary; another compiler's binary for the same instruction set has been
/// found to give them too.
class ED_EXPORT Simulation {
 public:
  /// Throws std::invalid_argument if the bodies are not of revolution, two of them overlap, a number is not finite, the
  /// box is too small for nearest images (see smallest_number; with cells, for three along an edge), or the contact
  /// options are not usable.
  explicit Simulation(const System& system, const SimulationOptions& options = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;             ///< the one moved from can only be assigned to or destroyed
  Simulation& operator=(Simulation&&) noexcept;  ///< the same

  double time() const;  ///< since the start

  /// Processes all events up to `time`, but at most `max_collisions` collisions. True if `time` was reached.
  bool run_until(double time, std::uint64_t max_collisions = ~std::uint64_t{0});

  /// Processes events until `number` more collisions have happened.
  void run_collisions(std::uint64_t number);

  /// Scales all positions and the box by a factor s, down to target_box / box if that leaves no overlap, else so that a
  /// tenth of the closest pair's gap is left; not below what the neighbour lists allow in one step, and not at all if
  /// 1 - s would be below least_gain. Returns the new box. Velocities are unchanged. Throws std::logic_error unless the
  /// neighbours are `dilated`.
  double shrink_box(double target_box, double least_gain = 0);

  /// Chooses the envelope's thickness by the work that the counters show, never by a clock. Runs up to about 20
  /// collisions a body. `keep_going` is asked after every hundred collisions; false: stops with the best so far.
  void tune_envelopes(const std::function<bool()>& keep_going = {});
  double envelope() const;  ///< thickness now, a length

  double box() const;         ///< edge length
  Counters counters() const;  ///< since the construction

  /// Sum over collisions of r_AB . dp, the momentum that B gains along the vector between the centres.
  double virial() const;

  /// Kinetic energies now; free flight does not change them.
  KineticState kinetic() const;

  /// All bodies at time(), wrapped into the box.
  System system() const;

  /// All bodies at time().
  void sample(Snapshot& snapshot) const;

  /// Keeps the next `number` collisions in collisions().
  void record_collisions(std::size_t number);
  const std::vector<Collision>& collisions() const;  ///< those that were asked for, so far

  /// The first pairs that failed, at most 16 for each reason.
  const std::vector<FailedPair>& failures() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ed
