#include "run/record.h"

#include "registry/observables.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include <sys/resource.h>

namespace hardbody {
namespace {

/// Rounding adds up to 1e-18 of the energy with every collision of a body that does not spin, and to 4e-17 of others
/// (physics_conservation_test, EnergyDrift): to this after 1e9 and 2.5e7 collisions of each body.
constexpr double kEnergyDrift = 1e-9;
constexpr double kMomentumDrift = 1e-9;  ///< momentum per body, in sqrt(m kT)

/// sqrt(m kT), m the mean mass: exactly 1 where all masses are 1.
double thermal_momentum(const ed::System& system) {
  double mass = 0;
  for (int i = 0; i < system.size(); ++i) mass += system.species_of(i).mass;
  return std::sqrt(mass / system.size());
}

}  // namespace

const ed::System& RunRecord::last_state() const {
  return produced() ? production.system : equilibration.system;
}

std::uint64_t RunRecord::failures_left_out() const {
  return equilibration.counters_of_start.unrecorded_failures + equilibration.counters_of_tuning.unrecorded_failures +
         equilibration.counters.unrecorded_failures + production.counters.unrecorded_failures;
}

Part part_of_all(const RunRecord& record) {
  const Config& config = record.config;
  const bool body_axes = !config.mixture && !config.all_of_revolution();
  return whole_part(record.production.results, config.groups(), body_axes, record.production.wave_numbers);
}

Part part_of_species(const RunRecord& record, std::size_t species, const ed::GroupResults& results) {
  const SpeciesConfig& own = record.config.species[species];
  const int axes = own.rotation_axes();
  return {.results = results,
          .number = own.number,
          .rotation_axes = static_cast<double>(axes),
          .body_axes = axes == 3,
          .spheres = !results.oriented,
          .wave_numbers = record.production.wave_numbers};
}

void audit_record(RunRecord& record) {
  const ed::System& state = record.last_state();
  record.audit = ed::audit(state);
  const ed::KineticState& begin =
      record.produced() ? record.production.kinetic_at_start : record.equilibration.kinetic_at_start;
  const ed::KineticState& end = record.audit.kinetic;
  record.energy_relative_drift = std::abs(end.energy() - begin.energy()) / begin.energy();
  record.momentum_drift = (end.momentum - begin.momentum).norm() / (state.size() * thermal_momentum(state));
  struct rusage usage = {};
  if (getrusage(RUSAGE_SELF, &usage) == 0) record.peak_memory_bytes = std::int64_t{1024} * usage.ru_maxrss;
}

std::vector<std::string> defects(const ed::Audit& audit) {
  std::vector<std::string> list;
  if (!audit.finite) list.emplace_back("the state holds numbers that are not finite");
  if (audit.overlaps > 0) {
    list.push_back(fmt::format("{} pairs overlap, the deepest by {:.3g} (bodies {} and {})", audit.overlaps,
                               -audit.minimum_distance, audit.closest_i, audit.closest_j));
  }
  if (audit.unanswered > 0) {
    list.push_back(fmt::format("{} pairs are too deep in each other for a distance", audit.unanswered));
  }
  return list;
}

std::vector<std::string> conservation_defects(const ed::KineticState& kinetic, const ed::System& system) {
  std::vector<std::string> list;
  const double n = system.size();
  const double wanted = 0.5 * (3 * n - 3 + kinetic.rotational_degrees_of_freedom + kinetic.spin_degrees_of_freedom);
  const double drift = std::abs(kinetic.energy() / wanted - 1);
  if (!(drift <= kEnergyDrift)) {
    list.push_back(fmt::format("the energy is {:.12g} kT instead of {:g}: off by {:.1e}, allowed {:.0e}",
                               kinetic.energy(), wanted, drift, kEnergyDrift));
  }
  const double momentum = kinetic.momentum.norm() / (n * thermal_momentum(system));
  if (!(momentum <= kMomentumDrift)) {
    list.push_back(
        fmt::format("the momentum is {:.1e} sqrt(m kT) a body instead of 0, allowed {:.0e}", momentum, kMomentumDrift));
  }
  return list;
}

std::vector<std::string> defects(const RunRecord& record) {
  std::vector<std::string> list = defects(record.audit);
  for (std::string& defect : conservation_defects(record.audit.kinetic, record.last_state())) {
    list.push_back(std::move(defect));
  }
  if (record.stall) list.push_back(fmt::format("{} {}", record.last_phase(), ed::describe(*record.stall)));
  const auto add = [&list](const ed::Counters& counters, const char* phase) {
    if (counters.overlaps > 0) list.push_back(fmt::format("{} overlaps were met during {}", counters.overlaps, phase));
    if (counters.declined > 0) {
      list.push_back(
          fmt::format("{} times during {} no method told whether a pair overlaps", counters.declined, phase));
    }
  };
  add(record.equilibration.counters_of_start, "the start");
  add(record.equilibration.counters_of_tuning, "the choice of the neighbour lists");
  add(record.equilibration.counters, "equilibration");
  add(record.production.counters, "production");
  return list;
}

}  // namespace hardbody
