#pragma once

#include "base/archive.h"
#include "loop/added_events.h"
#include "loop/any_event_loop.h"
#include "loop/collision_law.h"
#include "loop/loop_parts.h"
#include "loop/parts/stall_watch.h"

#include <ed/simulation.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace ed::internal {

/// The event loop behind Simulation: processes the earliest event of all bodies, again and again.
///
/// `Bodies`: UniaxialBodies or GeneralBodies. `Law`: see collision_law.h. `Added`: kinds of single-body events beyond
/// the loop's own (event_kinds.h), see added_events.h. Members are defined in event_loop_impl.h, for whoever needs a
/// law or events that the library is not built with.
template <class Bodies, CollisionLaw Law = SmoothElastic, class Added = AddedEvents<>>
class EventLoop final : public AnyEventLoop {
 public:
  EventLoop(const System& system, const SimulationOptions& options, Law law = {}, Added added = {});
  /// Makes the loop that was saved; see load_event_loop.
  EventLoop(const System& system, const SimulationOptions& options, Reader& reader, Law law = {}, Added added = {});

  double time() const override { return parts_.clock.time(); }
  bool run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events) override;
  double shrink_box(double target_box, double least_gain) override;
  void set_envelope(double thickness, bool shrinking = false) override;

  double box() const override { return parts_.box.edge(); }
  double envelope() const override { return parts_.neighbourhood.envelopes().thickness(); }
  Neighbours neighbours() const override { return parts_.options.neighbours; }
  int number() const override { return parts_.number(); }
  Counters counters() const override;
  std::uint64_t collisions_of(int first, int end) const override { return parts_.collisions.of_bodies(first, end); }
  double virial() const override { return parts_.collisions.virial(); }
  Eigen::Matrix3d virial_tensor() const override { return parts_.collisions.virial_tensor(); }
  System system() const override;
  void sample(Snapshot& snapshot) const override;
  void sample_translations(Snapshot& snapshot) const override;
  void record_collisions(std::size_t number) override { parts_.collisions.start_record(number); }
  const std::vector<Collision>& collisions() const override { return parts_.collisions.recorded(); }
  const std::vector<FailedPair>& failures() const override { return parts_.failures.pairs(); }
  const std::optional<Stall>& stall() const override { return watch_.stall(); }
  bool has_kernels() const override { return parts_.predictor.has_first_looks(); }
  void use(geom::InstructionSet set) override { parts_.use(set); }
  void save(Writer& writer) const override;

  const Law& law() const { return parts_.law; }
  const Added& added() const { return parts_.added; }

 private:
  struct Unbuilt {};  ///< tag: no envelopes, lists and events are made
  EventLoop(const System& system, const SimulationOptions& options, Unbuilt unbuilt, Law law, Added added);
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self);

  /// Makes envelopes of this thickness, lists and predictions. `poll`: see SimulationOptions.
  void make_lists(double thickness, bool shrinking, const std::function<void()>& poll);
  void process_next();
  double fastest_speed() const;
  void look_for_stall(double end);
  double possible_scale(double factor, double least_gain) const;

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  LoopParts<Bodies, Law, Added> parts_;
  StallWatch watch_;
};

}  // namespace ed::internal
