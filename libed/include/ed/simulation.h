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
  /// Certified: searches that needed the fallback over all normals. Bracketing: distances that Newton's method
  /// declined and the dual answered.
  std::uint64_t rescues = 0;
  std::uint64_t neighbour_rebuilds = 0;  ///< envelopes renewed
  std::uint64_t envelope_checks = 0;     ///< looks at whether a body leaves its envelope
  std::uint64_t candidate_tests = 0;     ///< pairs of envelopes tested in rebuilds
  /// Times a pair was found deeper than 1e-12 of its size: always 0 in a sound run. With Finder::bracketing not the
  /// number of contacts missed: one shows only if the bodies are still that deep when they are looked at again, and
  /// then at each look.
  std::uint64_t overlaps = 0;
  /// Times that no method told whether a pair overlaps, so that it was moved on without a certificate: always 0 in a
  /// sound run.
  std::uint64_t declined = 0;
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
  declined,  ///< no method tells whether the bodies overlap; they are looked at again a little later
};

/// The reason in words.
ED_EXPORT const char* to_string(FailureReason reason);

/// A pair that could not be predicted as it should, at the moment where that failed, with all that is needed to look at
/// it again.
struct FailedPair {
  FailureReason reason = FailureReason::overlap;
  BodyShape shape_i = geom::Ellipsoid(Eigen::Vector3d::Ones());
  BodyShape shape_j = geom::Ellipsoid(Eigen::Vector3d::Ones());
  Motion motion_i;
  Motion motion_j;  ///< in the image nearest to i
  double time = 0;  ///< simulated time
  int i = 0;
  int j = 1;
  Finder finder = Finder::certified;
  double eps_d = 0;                        ///< of Finder::bracketing
  std::optional<FailedDistance> distance;  ///< what gave no answer, if that is the reason
};

/// What an event of the run loop is.
enum class EventKind {
  exit,     ///< of a body from its envelope
  look,     ///< at a pair again, whose certified bound has come
  contact,  ///< of a pair
  added,    ///< of a single body, of a kind that is none of the library's
};

/// The enumerator's name.
ED_EXPORT const char* to_string(EventKind kind);

/// Many events in next to no time: a run that would never end. Always a defect, of the state or of the program.
struct Stall {
  double time = 0;                   ///< simulated
  std::uint64_t events = 0;          ///< so many of them
  double span = 0;                   ///< have taken so much simulated time
  EventKind kind = EventKind::exit;  ///< of the most frequent event since
  int i = 0;                         ///< its body, or the first
  int j = -1;                        ///< the second, of a pair
  double share = 0;                  ///< of that event among those since
};

/// In words, one line.
ED_EXPORT std::string describe(const Stall& stall);

/// How a simulation finds neighbours and contacts.
struct SimulationOptions {
  /// Thickness of the neighbour-list envelopes (length); 0: a first guess, which `tune_envelopes` improves.
  double envelope = 0;
  Neighbours neighbours = Neighbours::dilated;
  ContactOptions contact{};
  /// Instruction set of the vectors in which ellipsoids of revolution are looked at, all neighbours of a body at once
  /// (Finder::certified, not in cells); none: one pair at a time, and so is `best` where that is faster: near spheres,
  /// no vectors. And that in which bodies of any shape are found in the cells around another; none: that of the whole
  /// library. The results are the same, bit for bit.
  std::optional<geom::InstructionSet> batches = geom::InstructionSet::best;
  /// With so many bodies and more, 64 at the least, what the next events read is asked for in good time: a kilobyte a
  /// body, with lists and pairs, is more than the caches of a processor hold then. The results are the same, bit for
  /// bit.
  int prepare_from = 15000;
  /// A run has stalled when 2000 events a body take less than this share of the time in which the fastest of them moves
  /// by the smallest inscribed radius. Sound runs take some 10 such times.
  double least_progress = 1e-6;
};

/// The kind of neighbour list that bench_engine shows to be the fastest: cells for dilute bodies that are not spheres,
/// where a body would leave a dilated envelope ever again between two collisions, else dilated.
ED_EXPORT Neighbours fastest_neighbours(const BodyShape& shape, int number, double packing_fraction,
                                        Finder finder = Finder::certified);

/// Event-driven dynamics of hard convex bodies in a periodic cubic box: ellipsoids, superellipsoids, a user's own
/// shapes, and mixtures of them. Systems of ellipsoids of revolution alone (of any sizes) are the fast case.
///
/// Asynchronous: each body carries its own time. Neighbour lists with dilated envelopes; one calendar entry a body; a
/// pair is looked at once after a collision and its certified lower bound put into the calendar, to be refined only
/// when it comes up (with Finder::bracketing each search is carried to its end at once). Both the finder and the
/// neighbour lists can be the paper's; the collisions are the same. Nothing allocates in steady state. The same system
/// and options give the same bits from one binary; another compiler's binary for the same instruction set has been
/// found to give them too.
class ED_EXPORT Simulation {
 public:
  /// Throws std::invalid_argument if a species is not sound (check_species), two bodies overlap, a number is not
  /// finite, the box is too small for nearest images (see smallest_number; with cells, for three along an edge), or the
  /// contact options are not usable.
  explicit Simulation(const System& system, const SimulationOptions& options = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;             ///< the one moved from can only be assigned to or destroyed
  Simulation& operator=(Simulation&&) noexcept;  ///< the same

  double time() const;  ///< since the start

  /// Processes all events up to `time`, but at most `max_collisions` collisions and `max_events` events, of which a run
  /// that stalls has any number without a collision. True if `time` was reached. Once the run has stalled: false at
  /// once. In how many calls a time is reached changes no bit.
  bool run_until(double time, std::uint64_t max_collisions = ~std::uint64_t{0},
                 std::uint64_t max_events = ~std::uint64_t{0});

  /// Processes events until `number` more collisions have happened, or the run has stalled.
  void run_collisions(std::uint64_t number);

  /// Set once the run has stalled. The state is sound as a state and can be saved; restored, it is given another try.
  const std::optional<Stall>& stall() const;

  /// Scales all positions and the box by a factor s, down to target_box / box if that leaves no overlap, else so that a
  /// tenth of the closest pair's gap is left; not below what the neighbour lists allow in one step, and not at all if
  /// 1 - s would be below least_gain. Returns the new box. Velocities are unchanged. Throws std::logic_error unless the
  /// neighbours are `dilated`.
  double shrink_box(double target_box, double least_gain = 0);

  /// Chooses the envelope's thickness by the work that the counters show, never by a clock. Runs up to about 20
  /// collisions a body. `keep_going` is asked after every hundred collisions, sooner where these take many
  /// events; false: stops with the best so far.
  void tune_envelopes(const std::function<bool()>& keep_going = {});
  double envelope() const;  ///< thickness now, a length

  double box() const;         ///< edge length
  Counters counters() const;  ///< since the construction

  /// In how many collisions bodies number first to end - 1 took part, since the construction; a collision of two of
  /// them counts twice. 0 <= first <= end <= number of bodies, or std::invalid_argument is thrown.
  std::uint64_t collisions_of(int first, int end) const;

  /// Sum over collisions of r_AB . dp, the momentum that B gains along the vector between the centres.
  double virial() const;
  /// The tensor of which that is the trace: sum over collisions of r_AB dp^T. Symmetric on average only: bodies that
  /// are not spheres exchange angular momentum too.
  Eigen::Matrix3d virial_tensor() const;

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

  /// The whole state as bytes: a simulation restored from them goes on as this one does, bit for bit, counters and
  /// recorded collisions included. Changes nothing. The bytes carry no checksum, and are meant for the binary and the
  /// instruction set that wrote them.
  std::string save() const;
  /// The same piece by piece: of a million bodies they are a gigabyte.
  void save(const std::function<void(std::string_view)>& sink) const;

  /// The simulation that was saved. A shape of the user's, and ContactOptions::seed, are code: they are not in the
  /// state and must be the same again. Throws std::invalid_argument, `state: ..`, if the bytes are no state of bodies
  /// of these species with this finder and these neighbours; damaged ones are never trusted with an index or a length.
  static Simulation restore(std::string_view state, const std::vector<Species>& species,
                            const SimulationOptions& options = {});

 private:
  class Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace ed
