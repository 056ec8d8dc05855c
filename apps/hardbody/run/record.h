#pragma once

#include "config/config.h"

#include <ed/equilibration.h>
#include <ed/observables.h>
#include <ed/simulation.h>
#include <ed/system.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

struct Part;

/// Results of the equilibration.
struct Equilibration {
  ed::System system;
  ed::KineticState kinetic_at_start;
  double time = 0;
  double envelope = 0;                            ///< tuned thickness; 0: the simulation's own guess
  ed::Relaxation relaxation;                      ///< relaxation at its last full unit of time
  bool stopped = false;                           ///< a signal has stopped it
  ed::Counters counters_of_start;                 ///< counters of the compression before
  ed::Counters counters_of_tuning;                ///< counters of the trial runs that chose the envelope
  std::vector<ed::FailedPair> failures_of_start;  ///< failures of both
  double packing_of_file = 0;                     ///< packing fraction of the start's file; 0: there is none
  ed::Counters counters;
  std::vector<ed::FailedPair> failures;

  bool reached() const { return relaxation.reached; }
};

/// Results of production.
struct Production {
  ed::System system;  ///< system at its end
  ed::KineticState kinetic_at_start;
  double time = 0;
  double planned = 0;  ///< planned time; with a target error the longest one
  double longest_lag = 0;
  double next_look = 0;              ///< time of the next test of a target error
  bool precise = false;              ///< the target error is reached, which ended production
  std::vector<double> wave_numbers;  ///< wave numbers of F_self; the decay of the first one is fitted
  bool stopped = false;
  double wall_seconds = 0;
  double envelope = 0;
  ed::Counters counters;
  ed::Results results;
  std::vector<ed::FailedPair> failures;
};

/// Statistics that depend on when and how often a run was saved and resumed; they grow from one process to the next.
struct Upkeep {
  double seconds = 0;                    ///< wall time since the program took the run up
  double production_seconds = 0;         ///< wall time of production
  std::uint64_t checkpoints = 0;         ///< number of checkpoints written
  std::uint64_t checkpoints_failed = 0;  ///< number of checkpoints that could not be written
  std::uint64_t resumed = 0;             ///< number of times
};

/// Extent of events.csv.
struct EventsMark {
  std::uint64_t rows = 0;   ///< collisions
  std::uint64_t bytes = 0;  ///< header included; 0: there is no file
};

/// Extent of the trajectories, one for each file that the config asks for.
struct TrajectoryMark {
  std::uint64_t frames = 0;
  double last_time = -1;             ///< time of the last frame
  std::vector<std::uint64_t> bytes;  ///< bytes of each file; without a frame: 0
};

/// Lengths of the files that grow with production.
struct FilesMark {
  EventsMark events;
  TrajectoryMark trajectory;
};

/// Contents of a run's files and of its table.
struct RunRecord {
  Config config;
  Equilibration equilibration;
  Production production;             ///< empty if the run was stopped before
  ed::Audit audit;                   ///< audit of the last state
  double energy_relative_drift = 0;  ///< |E_end - E_start| / E_start over the last phase
  double momentum_drift = 0;         ///< |P_end - P_start| / (N sqrt(m kT)) over the last phase
  Upkeep upkeep;
  std::optional<ed::Stall> stall;  ///< stall that ended the run, if one did
  std::int64_t peak_memory_bytes = 0;

  bool stopped() const { return equilibration.stopped || production.stopped; }
  /// Whether production has begun, which may be of no length.
  bool produced() const { return !production.system.bodies.empty(); }
  const ed::System& last_state() const;
  /// Returns the number of pairs that failed and are not recorded, because there is room for a limited number.
  std::uint64_t failures_left_out() const;
  double last_time() const { return produced() ? production.time : equilibration.time; }
  const char* last_phase() const { return produced() ? "production" : "equilibration"; }
};

/// Returns all bodies of a run, as the registry of observables takes them. The record must outlive the result.
Part part_of_all(const RunRecord& record);

/// Returns a species of a mixture with its results, which must outlive the result.
Part part_of_species(const RunRecord& record, std::size_t species, const ed::GroupResults& results);

/// Fills in the audit of the last state, the drifts and the memory.
void audit_record(RunRecord& record);

/// Returns the defects that make a run's results worthless, one line each; empty for a sound run.
std::vector<std::string> defects(const RunRecord& record);

/// Returns the defects of a single state.
std::vector<std::string> defects(const ed::Audit& audit);

/// Energy and momentum that the dynamics has not conserved: every run starts with momentum zero and the energy that
/// kT = 1 gives, 1/2 for each degree of freedom: 3N - 3 of translation, 2 a body of revolution and 1 more if it spins,
/// 3 of any other.
std::vector<std::string> conservation_defects(const ed::KineticState& kinetic, const ed::System& system);

}  // namespace hardbody
