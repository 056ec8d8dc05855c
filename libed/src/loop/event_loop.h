#pragma once

#include "base/archive.h"
#include "base/large_vector.h"
#include "bodies/body_events.h"
#include "bodies/first_looks.h"
#include "cells/grid.h"
#include "contact/bracketing.h"
#include "contact/certified.h"
#include "loop/calendar.h"
#include "loop/prefetch_events.h"
#include "neighbours/envelopes.h"
#include "neighbours/lists.h"

#include <ed/simulation.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace ed::internal {

/// What Simulation needs of an event loop, whatever its bodies.
class AnyEventLoop {
 public:
  virtual ~AnyEventLoop() = default;

  virtual double time() const = 0;
  virtual bool run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events) = 0;
  virtual double shrink_box(double target_box, double least_gain) = 0;
  /// New envelopes of this thickness (clamped to what the box allows), and lists, for all bodies. With `shrinking`,
  /// bodies leave theirs early, so that the lists stay valid while the box shrinks a little.
  virtual void set_envelope(double thickness, bool shrinking = false) = 0;

  virtual double box() const = 0;
  virtual double envelope() const = 0;
  virtual Neighbours neighbours() const = 0;
  virtual int number() const = 0;
  virtual Counters counters() const = 0;
  virtual std::uint64_t collisions_of(int first, int end) const = 0;
  virtual double virial() const = 0;
  virtual Eigen::Matrix3d virial_tensor() const = 0;
  virtual System system() const = 0;
  virtual void sample(Snapshot& snapshot) const = 0;
  virtual void record_collisions(std::size_t number) = 0;
  virtual const std::vector<Collision>& collisions() const = 0;
  virtual const std::vector<FailedPair>& failures() const = 0;
  virtual const std::optional<Stall>& stall() const = 0;

  /// The whole state between two events; what the constructor makes of species and options is left out.
  virtual void save(Writer& writer) const = 0;
};

/// The loop for these bodies: the fast one if they are all ellipsoids of revolution. Throws as Simulation does, but for
/// species (check_species) and overlaps.
std::unique_ptr<AnyEventLoop> make_event_loop(const System& system, const SimulationOptions& options);

/// The loop that was saved. `system`: its box and species, and bodies that have only these. Throws
/// std::invalid_argument for bytes that are no state of such bodies.
std::unique_ptr<AnyEventLoop> load_event_loop(const System& system, const SimulationOptions& options, Reader& reader);

/// The event loop behind Simulation. `Bodies`: UniaxialBodies or GeneralBodies.
///
/// Times inside are measured from the start of the current epoch (epoch_ long); at its end all bodies are moved there
/// and every time is shifted, so that no digits are lost however long a run lasts.
///
/// Each pair of neighbours carries a certified lower bound of its contact time, made after the last collision of either
/// body, and is refined only when the calendar comes to it. A pair counts in the calendar entry of one of its bodies,
/// its owner: the one that was predicted last.
template <class Bodies>
class EventLoop final : public AnyEventLoop {
 public:
  EventLoop(const System& system, const SimulationOptions& options);
  /// See load_event_loop.
  EventLoop(const System& system, const SimulationOptions& options, Reader& reader);

  double time() const override { return epochs_ * epoch_ + now_; }
  bool run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events) override;
  double shrink_box(double target_box, double least_gain) override;
  void set_envelope(double thickness, bool shrinking = false) override;

  double box() const override { return box_; }
  double envelope() const override { return envelopes_->thickness(); }
  Neighbours neighbours() const override { return options_.neighbours; }
  int number() const override { return bodies_.number(); }
  Counters counters() const override;
  std::uint64_t collisions_of(int first, int end) const override;
  double virial() const override { return virial_; }
  Eigen::Matrix3d virial_tensor() const override { return virial_tensor_; }
  System system() const override;
  void sample(Snapshot& snapshot) const override;
  void record_collisions(std::size_t number) override;
  const std::vector<Collision>& collisions() const override { return collisions_; }
  const std::vector<FailedPair>& failures() const override { return failures_; }
  const std::optional<Stall>& stall() const override { return stall_; }
  void save(Writer& writer) const override;

 private:
  struct Unbuilt {};  ///< without envelopes, lists and events
  EventLoop(const System& system, const SimulationOptions& options, Unbuilt unbuilt);
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self);
  void load_failures(Reader& reader);
  bool events_fit() const;

  static constexpr std::int32_t kExit = BodyEvents::kExit;
  static constexpr std::int32_t kNoPair = -1;
  static constexpr std::size_t kReasons = 1 + static_cast<std::size_t>(FailureReason::declined);  ///< of FailureReason
  static constexpr std::size_t kMaxFailuresRecorded = 16;                                         ///< for each reason
  /// Room for collisions that are recorded; more grow as they come.
  static constexpr std::size_t kCollisionsReserved = std::size_t{1} << 20;
  /// Room for candidates beyond those that become neighbours: a block of each cell that is looked into, at most.
  static constexpr std::size_t kCandidatesReserved = 2048;
  /// Events a body after which it is asked whether the run still makes progress, and how many events are then looked at
  /// to say what it is stuck in.
  static constexpr std::uint64_t kStallEvents = 2000;
  static constexpr int kStallSample = 1000;

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  void process_next();
  bool progresses() const;
  void look_for_stall(double end);
  Stall most_frequent_event(double end);
  void process_exit(int body);
  void process_contact(std::int32_t index);
  void refine(std::int32_t index);
  void start_epoch();

  void rebuild(int body);
  void reserve_for_events();
  void rebuild_all();
  void renew_exit(int body);

  void predict(std::int32_t index, int owner, int max_evaluations);
  Pair& claim(std::int32_t index, int owner);
  double search_end(const Pair& pair) const;
  void search(Pair& pair, int max_evaluations);
  void keep(Pair& pair, const Finding& finding);
  Eigen::Vector3d between(const Pair& pair) const;
  double parting_time(const Pair& pair) const;
  void queue(std::int32_t index, int owner);
  EventSources<Bodies> sources() const { return {calendar_, bodies_, lists_, *envelopes_, *cells_}; }
  void fetch_pairs(int body) const;     ///< read soon
  void fetch_partners(int body) const;  ///< after fetch_pairs and something else to do: it reads the pairs
  void queue_all_of(int body, std::int32_t skip);
  void predict_queued();
  void predict_all();
  void reschedule(int body);
  void reschedule_orphans();
  Motion motion_of(int body, double t) const;
  void report(const Pair& pair, double time, FailureReason reason);

  void wrap(int body);

  SimulationOptions options_;
  std::vector<Species> species_;
  std::vector<int> species_of_;  ///< number of each body's
  double box_;

  // State of the bodies.
  Bodies bodies_;
  LargeVector<Eigen::Vector3i> images_;

  // Neighbours and events.
  std::unique_ptr<Envelopes<Bodies>> envelopes_;
  std::optional<CellGrid> cells_;
  NeighbourLists lists_;
  Calendar calendar_;
  std::optional<EventsAhead<Bodies>> ahead_;         ///< if most of what an event reads is not in the caches
  std::vector<int> orphans_;                         ///< whose first event, a pair, is no longer theirs; perhaps twice
  std::unique_ptr<FirstLooks<Bodies>> first_looks_;  ///< null: pairs are looked at one by one
  std::vector<Look> queue_;                          ///< pairs to be predicted
  std::vector<NearBody> near_;
  std::vector<Meeting> meetings_;
  std::vector<std::int32_t> old_pairs_;

  double list_scale_ = 1;  ///< by what the box has shrunk since all lists were made
  double epoch_ = 1;
  double now_ = 0;
  double epochs_ = 0;
  double virial_ = 0;
  Eigen::Matrix3d virial_tensor_ = Eigen::Matrix3d::Zero();
  Counters counters_;
  LargeVector<std::uint64_t> collisions_of_;  ///< each body
  FinderCounters finder_;
  std::vector<Collision> collisions_;
  std::size_t collisions_wanted_ = 0;
  std::vector<FailedPair> failures_;
  std::array<std::size_t, kReasons> failures_of_{};  ///< recorded, by reason
  std::optional<Unsolved> unsolved_;                 ///< by the last search
  std::uint64_t events_ = 0;                         ///< since stall_watch_
  double stall_watch_ = 0;                           ///< time when it was last asked whether the run has stalled
  std::optional<Stall> stall_;
};

}  // namespace ed::internal
