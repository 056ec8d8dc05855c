#pragma once

#include "axis_motion.h"
#include "bracketing_contact.h"
#include "calendar.h"
#include "cell_envelopes.h"
#include "cell_grid.h"
#include "certified_contact.h"
#include "envelopes.h"
#include "neighbour_lists.h"

#include <ed/impulse.h>
#include <ed/simulation.h>

#include <geom/internal/uniaxial.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace ed::internal {

/// The event loop behind Simulation.
///
/// Times inside are measured from the start of the current epoch (kEpoch long); at its end all bodies are moved there
/// and every time is shifted, so that no digits are lost however long a run lasts.
///
/// Each pair of neighbours carries a certified lower bound of its contact time, made after the last collision of either
/// body, and is refined only when the calendar comes to it. A pair counts in the calendar entry of one of its bodies,
/// its owner: the one that was predicted last.
class EventLoop {
 public:
  EventLoop(const System& system, const SimulationOptions& options);

  double time() const { return epochs_ * kEpoch + now_; }
  bool run_until(double time, std::uint64_t max_collisions);
  double shrink_box(double target_box, double least_gain);
  /// New envelopes of this thickness (clamped to what the box allows), and lists, for all bodies. With `shrinking`,
  /// bodies leave theirs early, so that the lists stay valid while the box shrinks a little.
  void set_envelope(double thickness, bool shrinking = false);

  double box() const { return box_; }
  double envelope() const { return envelopes_->thickness(); }
  Neighbours neighbours() const { return options_.neighbours; }
  int number() const { return static_cast<int>(motions_.size()); }
  Counters counters() const;
  double virial() const { return virial_; }
  KineticState kinetic() const;
  System system() const;
  void sample(Snapshot& snapshot) const;
  void record_collisions(std::size_t number);
  const std::vector<Collision>& collisions() const { return collisions_; }
  const std::vector<FailedPair>& failures() const { return failures_; }
  double bounding_radius() const { return bounding_radius_; }

 private:
  static constexpr std::int32_t kExit = -1;
  static constexpr std::size_t kReasons = 2;               ///< of FailureReason
  static constexpr std::size_t kMaxFailuresRecorded = 16;  ///< for each reason

  void process_next();
  void process_exit(int body);
  void process_contact(std::int32_t index);
  void refine(std::int32_t index);
  void start_epoch();

  void rebuild(int body);
  void rebuild_all();
  void renew_exit(int body);

  void predict(std::int32_t index, int owner, int max_evaluations);
  Finding find_contact(Pair& pair, double end, int max_evaluations);
  void search(Pair& pair, int max_evaluations);
  Eigen::Vector3d between(const Pair& pair) const;
  double parting_time(const Pair& pair) const;
  void check_cells() const;
  void predict_all_of(int body, std::int32_t skip);
  void reschedule(int body);
  void reschedule_orphans();
  double contact_scale(const Pair& pair, double enough) const;
  void report(const Pair& pair, double time, FailureReason reason);

  void move(int body);
  Eigen::Vector3d position_now(int body) const;
  void wrap(int body);
  Motion motion_of(int body, double t) const;
  ContactBody contact_body(int body, const Eigen::Vector3d& normal) const;

  SimulationOptions options_;

  // What all bodies share.
  Species species_;
  geom::Ellipsoid upright_;  ///< the shape with its axis of revolution along body z
  int shape_axis_;
  geom::internal::Spheroid shape_;
  UniaxialInertia inertia_;
  double bounding_radius_;
  double box_;

  // State of the bodies.
  std::vector<AxisMotion> motions_;
  std::vector<BodyFrame> frames_;
  std::vector<Eigen::Vector3i> images_;

  // Neighbours and events.
  std::unique_ptr<Envelopes> envelopes_;
  const CellEnvelopes* body_cells_ = nullptr;  ///< envelopes_, if they are cells
  std::optional<CellGrid> cells_;
  NeighbourLists lists_;
  Calendar calendar_;
  std::vector<double> exits_;        ///< lower bound of when a body leaves its envelope
  std::vector<std::int32_t> first_;  ///< what a body's calendar entry is: a pair, or kExit
  std::vector<int> orphans_;         ///< bodies whose first event has gone to another owner
  std::vector<NearBody> near_;
  std::vector<std::int32_t> old_pairs_;

  double list_scale_ = 1;  ///< by what the box has shrunk since all lists were made
  double now_ = 0;
  double epochs_ = 0;
  double virial_ = 0;
  Counters counters_;
  FinderCounters finder_;
  std::vector<Collision> collisions_;
  std::size_t collisions_wanted_ = 0;
  std::vector<FailedPair> failures_;
  std::array<std::size_t, kReasons> failures_of_{};  ///< recorded, by reason
  std::optional<Unsolved> unsolved_;                 ///< by the last search
};

}  // namespace ed::internal
