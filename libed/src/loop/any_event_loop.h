#pragma once

#include "base/archive.h"

#include <ed/simulation.h>

#include <geom/batch.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace ed::internal {

/// Interface of an event loop that Simulation uses, whatever its bodies.
class AnyEventLoop {
 public:
  virtual ~AnyEventLoop() = default;

  virtual double time() const = 0;
  virtual bool run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events) = 0;
  virtual double shrink_box(double target_box, double least_gain) = 0;
  /// Makes new envelopes of this thickness (clamped to what the box allows), and lists, for all bodies. With
  /// `shrinking`, bodies leave theirs early, so that the lists stay valid while the box shrinks a little.
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
  virtual void sample_translations(Snapshot& snapshot) const = 0;
  virtual void record_collisions(std::size_t number) = 0;
  virtual const std::vector<Collision>& collisions() const = 0;
  virtual const std::vector<FailedPair>& failures() const = 0;
  virtual const std::optional<Stall>& stall() const = 0;

  /// Returns whether kernels of several instruction sets can take the pairs.
  virtual bool has_kernels() const = 0;
  /// Uses the kernels of an instruction set from now on, which changes no bits; only with has_kernels().
  virtual void use(geom::InstructionSet set) = 0;

  /// Writes the whole state between two events, except for what the constructor makes of species and options.
  virtual void save(Writer& writer) const = 0;
};

/// Makes the loop for these bodies: the fast one if they are all ellipsoids of revolution. Throws as Simulation does,
/// except for bad species (check_species) and overlaps.
std::unique_ptr<AnyEventLoop> make_event_loop(const System& system, const SimulationOptions& options);

/// Makes the loop that was saved. `system`: its box and species, and bodies that have only these. Throws
/// std::invalid_argument for bytes that are no state of such bodies.
std::unique_ptr<AnyEventLoop> load_event_loop(const System& system, const SimulationOptions& options, Reader& reader);

}  // namespace ed::internal
