#pragma once

#include <ed/contact_options.h>
#include <ed/export.h>
#include <ed/motion.h>
#include <ed/snapshot.h>
#include <ed/system.h>

#include <geom/batch.h>

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ed {

/// Counters of the event loop since its construction.
struct Counters {
  std::uint64_t collisions = 0;
  std::uint64_t predictions = 0;   ///< contact searches started, refinements included
  std::uint64_t evaluations = 0;   ///< evaluations of a pair at a point in time
  std::uint64_t kernel_calls = 0;  ///< evaluations of the gap function along one normal
  /// Evaluations after a prediction's first, which refine its lower bound when that time is reached. The final Newton
  /// on a contact (2 evaluations a collision) is not counted here.
  std::uint64_t refinements = 0;
  std::uint64_t cold_restarts = 0;  ///< warm starts that converged to a spurious maximum
  /// Certified: searches that needed the fallback over all normals. Bracketing: distances that Newton's method declined
  /// and the dual method answered.
  std::uint64_t rescues = 0;
  std::uint64_t neighbour_rebuilds = 0;  ///< envelopes renewed
  std::uint64_t envelope_checks = 0;     ///< checks whether a body leaves its envelope
  std::uint64_t candidate_tests = 0;     ///< pairs of envelopes tested in rebuilds
  /// Number of times that a pair was found to overlap by more than 1e-12 of its size: always 0 in a sound run. With
  /// Finder::bracketing it is not the number of missed contacts: a missed contact is counted only if the bodies still
  /// overlap by that much when they are evaluated again, and then at each evaluation.
  std::uint64_t overlaps = 0;
  /// Number of times that no method could decide whether a pair overlaps, so that it was moved on without a
  /// certificate: always 0 in a sound run.
  std::uint64_t declined = 0;
  /// Contacts at which the bodies did not approach: no impulse, not counted as collisions. Always 0 in a sound run.
  std::uint64_t parting_contacts = 0;
  std::uint64_t unrecorded_failures = 0;  ///< failed pairs that did not fit into failures()

  /// Adds the counts of another stretch of a run, or of another run.
  ED_EXPORT Counters& operator+=(const Counters& other);
};

/// Collision of two bodies.
struct Collision {
  double time;  ///< time since the simulation's start
  int i;
  int j;
};

/// Reason for which the prediction of a pair failed.
enum class FailureReason {
  overlap,   ///< the bodies overlap by more than rounding
  distance,  ///< Newton's method for a distance gave no answer
  declined,  ///< no method can decide whether the bodies overlap; they are tested again a little later
};

/// Describes the reason in words.
ED_EXPORT const char* to_string(FailureReason reason);

/// Pair whose prediction failed, at the moment of the failure, with all data needed to reproduce it.
struct FailedPair {
  FailureReason reason = FailureReason::overlap;
  BodyShape shape_i = geom::Ellipsoid(Eigen::Vector3d::Ones());
  BodyShape shape_j = geom::Ellipsoid(Eigen::Vector3d::Ones());
  Motion motion_i;
  Motion motion_j;  ///< motion of j, in the image nearest to i
  double time = 0;  ///< simulated time
  int i = 0;
  int j = 1;
  Finder finder = Finder::certified;
  double eps_d = 0;                        ///< eps_d of Finder::bracketing
  std::optional<FailedDistance> distance;  ///< the call that gave no answer, if that is the reason
};

/// Kind of an event of the run loop.
enum class EventKind {
  exit,     ///< a body leaves its envelope
  look,     ///< a pair is evaluated again, because its certified bound is reached
  contact,  ///< a pair is in contact
  added,    ///< event of a single body, of a kind that the library does not define
};

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(EventKind kind);

/// Stall of a run: many events within almost no simulated time, so that it would never end. Always a defect, of the
/// state or of the program.
struct Stall {
  double time = 0;                   ///< simulated time of the stall
  std::uint64_t events = 0;          ///< number of events
  double span = 0;                   ///< simulated time that these events have taken
  EventKind kind = EventKind::exit;  ///< kind of the most frequent event since
  int i = 0;                         ///< body of that event, or its first body
  int j = -1;                        ///< second body, if that event is of a pair
  double share = 0;                  ///< fraction of that event among the events since
};

/// Describes the stall in one line.
ED_EXPORT std::string describe(const Stall& stall);

/// Settings of a simulation: neighbours, contacts, vector kernels.
struct SimulationOptions {
  /// Thickness of the neighbour-list envelopes (length); 0: a first guess, which `tune_envelopes` improves.
  double envelope = 0;
  Neighbours neighbours = Neighbours::dilated;
  ContactOptions contact{};
  /// Instruction set of two kernels. One evaluates ellipsoids of revolution, capsules and spheres in vectors, all
  /// neighbours of a body at once (Finder::certified, neighbours other than cells), but for capsules beside ellipsoids,
  /// which are evaluated one pair at a time; nullopt evaluates all so, and so does `best` if that is faster: ellipsoids
  /// near spheres, no vectors. The other finds bodies of any shape in the cells around a body; nullopt uses that of the
  /// whole library. The results are the same, bit for bit.
  std::optional<geom::InstructionSet> batches = geom::InstructionSet::best;
  /// Smallest number of bodies for which upcoming events are prefetched (>= 64). A body takes a kilobyte, with lists
  /// and pairs: from this number on that is more than the caches of a processor hold. The results are the same, bit for
  /// bit.
  int prepare_from = 15000;
  /// Stall criterion: a run has stalled when 2000 events a body take less than this fraction of the time in which the
  /// fastest of them moves by the smallest inscribed radius. Sound runs take about 10 such times.
  double least_progress = 1e-6;
  /// Called, unless empty, once every few hundred bodies while a simulation is constructed, never by a restore or a
  /// run; an exception that it throws ends the construction. Ten million bodies take minutes.
  std::function<void()> poll{};
};

/// Returns the kind of neighbour list that is the fastest according to bench_engine: cells for dilute bodies that are
/// not spheres, where a body would leave a dilated envelope again and again between two collisions, else dilated.
ED_EXPORT Neighbours fastest_neighbours(const BodyShape& shape, int number, double packing_fraction,
                                        Finder finder = Finder::certified);

/// Event-driven dynamics of hard convex bodies in a periodic cubic box: ellipsoids, superellipsoids, spheres, capsules,
/// boxes, polyhedra, a user's own shapes, and mixtures of them. Systems of ellipsoids of revolution, capsules and
/// spheres (of any sizes) are the fast case.
///
/// The dynamics is asynchronous: each body carries its own time. Neighbour lists use dilated envelopes; the calendar
/// has one entry a body. A pair is evaluated once after a collision, and its certified lower bound is put into the
/// calendar, to be refined only when that time is reached (with Finder::bracketing each search is completed at once).
/// Both the finder and the neighbour lists can be the paper's; the collisions are the same. Nothing allocates in steady
/// state. The same system and options give the same bits from one binary; another compiler's binary for the same
/// instruction set has been found to give them too.
class ED_EXPORT Simulation {
 public:
  /// Constructs a simulation that starts from `system`. Throws std::invalid_argument if a species is not sound
  /// (check_species), two bodies overlap, a number is not finite, the box is too small for nearest images (see
  /// smallest_number; with cells, for three along an edge), or the contact options are not usable.
  explicit Simulation(const System& system, const SimulationOptions& options = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;             ///< moved-from objects can only be assigned to or destroyed
  Simulation& operator=(Simulation&&) noexcept;  ///< moved-from objects can only be assigned to or destroyed

  double time() const;  ///< time since the start

  /// Processes all events up to `time`, but at most `max_collisions` collisions and `max_events` events; the latter
  /// limit matters for a stalling run, which has many events without a collision. Returns true if `time` was reached.
  /// Returns false at once if the run has stalled. Splitting a run into several calls gives bit-identical results.
  bool run_until(double time, std::uint64_t max_collisions = ~std::uint64_t{0},
                 std::uint64_t max_events = ~std::uint64_t{0});

  /// Processes events until `number` more collisions have happened, or the run has stalled. Throws
  /// std::invalid_argument if number > 0 and all bodies are at rest: there will be no collision.
  void run_collisions(std::uint64_t number);

  /// Returns the stall once the run has stalled, else nullopt. The state is still valid and can be saved; after a
  /// restore the run may continue.
  const std::optional<Stall>& stall() const;

  /// Scales all positions and the box by a factor s, down to target_box / box if that causes no overlap, else so that a
  /// tenth of the closest pair's gap is left; never below what the neighbour lists allow in one step, and not at all if
  /// 1 - s would be below least_gain. Returns the new box. Velocities are unchanged. Throws std::logic_error unless the
  /// neighbours are `dilated`.
  double shrink_box(double target_box, double least_gain = 0);

  /// Chooses the envelope's thickness by the work that the counters show, never by a clock. Runs trials, mostly three
  /// to six, of 3 collisions a body each, but no fewer than 6144; the time advances. `keep_going` is called after every
  /// hundred collisions, sooner if these take many events; if it returns false, tuning stops with the best thickness so
  /// far. Throws std::invalid_argument if all bodies are at rest, except with `cells`, which have no envelopes.
  void tune_envelopes(const std::function<bool()>& keep_going = {});
  double envelope() const;  ///< current thickness, a length

  double box() const;         ///< edge length of the box
  Counters counters() const;  ///< counters since the construction

  /// Returns the number of collisions in which bodies number first to end - 1 took part, since the construction; a
  /// collision of two of them counts twice. Throws std::invalid_argument unless 0 <= first <= end <= number of bodies.
  std::uint64_t collisions_of(int first, int end) const;

  /// Returns the sum over collisions of r_AB . dp, where dp is the momentum that B gains and r_AB the vector between
  /// the centres.
  double virial() const;
  /// Returns the tensor whose trace is virial(): the sum over collisions of r_AB dp^T. It is symmetric on average only:
  /// bodies that are not spheres exchange angular momentum too.
  Eigen::Matrix3d virial_tensor() const;

  /// Returns the current kinetic energies; free flight does not change them.
  KineticState kinetic() const;

  /// Returns all bodies at time(), wrapped into the box.
  System system() const;

  /// Fills `snapshot` with all bodies at time().
  void sample(Snapshot& snapshot) const;

  /// Fills `snapshot` with time, positions and velocities alone, in a fraction of the time. There are no rotations
  /// then, and what else belongs to orientations keeps its values, or is zero where the snapshot was of another number
  /// of bodies.
  void sample_translations(Snapshot& snapshot) const;

  /// Starts recording: collisions() will hold the next `number` collisions.
  void record_collisions(std::size_t number);
  const std::vector<Collision>& collisions() const;  ///< collisions recorded so far

  /// Returns the first pairs whose prediction failed, at most 16 for each reason.
  const std::vector<FailedPair>& failures() const;

  /// Returns the whole state as bytes: a simulation restored from them continues bit for bit as this one does, counters
  /// and recorded collisions included. Changes nothing. The bytes carry no checksum, and are meant for the binary and
  /// the instruction set that wrote them.
  std::string save() const;
  /// Overload that hands the bytes on piece by piece: a million bodies take a gigabyte.
  void save(const std::function<void(std::string_view)>& sink) const;

  /// Restores a saved simulation. Shapes defined by the user, and ContactOptions::seed, are code: they are not in the
  /// state and must be passed again unchanged. Throws std::invalid_argument, `state: ..`, if the bytes are no state of
  /// bodies of these species with this finder and these neighbours; an index or a length in damaged bytes is never
  /// trusted.
  static Simulation restore(std::string_view state, const std::vector<Species>& species,
                            const SimulationOptions& options = {});

 private:
  class Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ed
