#include "run_record.h"

#include <fmt/format.h>

#include <cmath>

#include <sys/resource.h>

namespace hardbody {
namespace {

constexpr double kDecayedC2 = 0.05;
constexpr double kTravelled = 1;  ///< of the mean square displacement, l^2

}  // namespace

bool Equilibration::reached(const Config& config) const {
  // Spheres without friction turn freely: how their orientations decay says nothing of the state.
  const bool sphere = config.true_aspect_ratio() == 1;
  return msd > kTravelled && (sphere || c2 < kDecayedC2);
}

const ed::System& RunRecord::last_state() const {
  return production.planned > 0 ? production.system : equilibration.system;
}

void audit_record(RunRecord& record) {
  const ed::System& state = record.last_state();
  record.audit = ed::audit(state);
  const ed::KineticState& begin =
      record.production.planned > 0 ? record.production.kinetic_at_start : record.equilibration.kinetic_at_start;
  const ed::KineticState& end = record.audit.kinetic;
  record.energy_relative_drift = std::abs(end.energy() - begin.energy()) / begin.energy();
  // The thermal momentum sqrt(m kT) is 1.
  record.momentum_drift = (end.momentum - begin.momentum).norm() / state.size();
  struct rusage usage = {};
  if (getrusage(RUSAGE_SELF, &usage) == 0) record.peak_memory_bytes = std::int64_t{1024} * usage.ru_maxrss;
}

std::vector<std::string> defects(const ed::Audit& audit) {
  std::vector<std::string> list;
  if (!audit.finite) list.emplace_back("the state holds numbers that are not finite");
  if (audit.minimum_distance < -ed::kAuditOverlap) {
    list.push_back(fmt::format("{} pairs overlap, the deepest by {:.3g} (bodies {} and {})", audit.overlaps,
                               -audit.minimum_distance, audit.closest_i, audit.closest_j));
  }
  if (audit.unanswered > 0) {
    list.push_back(fmt::format("{} pairs are too deep in each other for a distance", audit.unanswered));
  }
  return list;
}

std::vector<std::string> defects(const RunRecord& record) {
  std::vector<std::string> list = defects(record.audit);
  if (record.equilibration.overlaps > 0) {
    list.push_back(fmt::format("{} overlaps were met during equilibration", record.equilibration.overlaps));
  }
  if (record.production.counters.overlaps > 0) {
    list.push_back(fmt::format("{} overlaps were met during production", record.production.counters.overlaps));
  }
  return list;
}

}  // namespace hardbody
