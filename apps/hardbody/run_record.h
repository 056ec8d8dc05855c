#pragma once

#include "config.h"

#include <ed/observables.h>
#include <ed/simulation.h>
#include <ed/system.h>

#include <cstdint>
#include <string>
#include <vector>

namespace hardbody {

/// What the equilibration left.
struct Equilibration {
  ed::System system;
  ed::KineticState kinetic_at_start;
  double time = 0;
  double envelope = 0;   ///< tuned thickness; 0: the simulation's own guess
  double c2 = 1;         ///< <P2(u(t).u(0))> between its begin and its end
  double msd = 0;        ///< <|r(t) - r(0)|^2> between them
  bool stopped = false;  ///< by a signal
  ed::Counters counters;
  std::vector<ed::FailedPair> failures;

  bool reached(const Config& config) const;
};

/// What production measured.
struct Production {
  ed::System system;
  ed::KineticState kinetic_at_start;
  double time = 0;
  double planned = 0;
  bool stopped = false;
  double wall_seconds = 0;
  double envelope = 0;
  ed::Counters counters;
  ed::Results results;
  std::vector<ed::Collision> collisions;
  std::vector<ed::FailedPair> failures;
};

/// Everything that a run's files and its table say.
struct RunRecord {
  Config config;
  Equilibration equilibration;
  Production production;             ///< empty if the run was stopped before
  ed::Audit audit;                   ///< of the last state
  double energy_relative_drift = 0;  ///< |E_end - E_start| / E_start over the last phase
  double momentum_drift = 0;         ///< |P_end - P_start| / (N sqrt(m kT)) over the last phase
  double total_seconds = 0;          ///< wall time since the program took the run up
  std::int64_t peak_memory_bytes = 0;

  bool stopped() const { return equilibration.stopped || production.stopped; }
  const ed::System& last_state() const;
  std::uint64_t failures_left_out() const {
    return equilibration.counters.unrecorded_failures + production.counters.unrecorded_failures;
  }
  double last_time() const { return production.planned > 0 ? production.time : equilibration.time; }
  const char* last_phase() const { return production.planned > 0 ? "production" : "equilibration"; }
};

/// Fills in the audit of the last state, the drifts and the memory.
void audit_record(RunRecord& record);

/// What makes a run's results worthless, one line each; empty for a sound run.
std::vector<std::string> defects(const RunRecord& record);

/// The same for a single state.
std::vector<std::string> defects(const ed::Audit& audit);

/// Energy and momentum that the dynamics has not conserved: every run starts with momentum zero and the energy that
/// kT = 1 gives, (3N - 3)/2 + N, and N/2 more if the bodies spin.
std::vector<std::string> conservation_defects(const ed::KineticState& kinetic, const ed::System& system);

}  // namespace hardbody
