#include "audit/trajectory.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/number_text.h"
#include "commands/commands.h"
#include "config/config.h"
#include "io/run_directory.h"
#include "run/checkpoint.h"
#include "run/record.h"
#include "start/agreement.h"
#include "trajectory/reader.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

std::string yes_or_no(bool yes) {
  return yes ? "yes" : "NO";
}

void print_state(const Checkpoint& checkpoint, const ed::Audit& audit) {
  const ed::KineticState& kinetic = audit.kinetic;
  report_row("state at", fmt::format("time {:g} of {}, written by hardbody {}", checkpoint.time, checkpoint.phase,
                                     checkpoint.program_version));
  report_row("bodies", fmt::format("{}", checkpoint.system.size()));
  report_row("all numbers finite", yes_or_no(audit.finite));
  if (audit.finite) {
    report_row("overlaps", fmt::format("{}", audit.overlaps));
    report_row("distances not answered", fmt::format("{}", audit.unanswered));
    report_row("minimum distance", audit.closest_i < 0
                                       ? std::string("no two bounding spheres meet")
                                       : fmt::format("{:.6g} l, bodies {} and {}", audit.minimum_distance,
                                                     audit.closest_i, audit.closest_j));
  } else {
    report_row("overlaps", "not tested");
  }
  report_row("energy", fmt::format("{:.10g} kT (translation {:.6g}, rotation {:.6g}, spin {:.6g})", kinetic.energy(),
                                   kinetic.translational_energy, kinetic.rotational_energy, kinetic.spin_energy));
  report_row("translational temperature", fmt::format("{:.6f} on 3N - 3 degrees of freedom", kinetic.translational_kT));
  report_row("rotational temperature",
             fmt::format("{:.6f} on {}", kinetic.rotational_kT,
                         freedoms_text(kinetic.rotational_degrees_of_freedom, checkpoint.system.size())));
  report_row("momentum", fmt::format("{:.2e} sqrt(m kT) a body", kinetic.momentum.norm() / checkpoint.system.size()));
}

/// Compares the state with the config it was made with, prints the result and returns whether they agree.
bool print_config(const Checkpoint& checkpoint, const std::string& name) {
  const Config config = parse_config(checkpoint.config, name + " (its config)");
  const double phi = ed::packing_fraction(checkpoint.system);
  const bool same_phi = std::abs(phi / config.packing_fraction - 1) < kStateRounding;
  const Agreement same = compare(checkpoint.system, config);
  report_row("packing fraction", fmt::format("{:.15g}, as configured: {}", phi, yes_or_no(same_phi)));
  report_row("number as configured", yes_or_no(same.number));
  report_row("shape as configured", yes_or_no(same.shape));
  report_row("inertia as configured", yes_or_no(same.dynamics));
  return same_phi && same.number && same.shape && same.dynamics;
}

}  // namespace

int check(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) {
    throw InputError(fmt::format(
        "{}: cannot be read: No such file or directory; accepted: a run directory, a GSD file or a LAMMPS dump", path));
  }
  if (!fs::is_directory(status)) return check_trajectory(*open_frames(path));
  const fs::path file = fs::path(path) / kCheckpointFile;
  const Checkpoint checkpoint = read_checkpoint(file);
  const ed::Audit result = audited(checkpoint.system, file.string());
  console().print(fmt::format("{}\n", file.string()));
  print_state(checkpoint, result);
  std::vector<std::string> list = defects(result);
  for (std::string& defect : conservation_defects(result.kinetic, checkpoint.system)) list.push_back(std::move(defect));
  if (!print_config(checkpoint, file.string())) list.emplace_back("the state does not match its config");
  for (const std::string& defect : list) console().print(fmt::format("  *** NOT SOUND: {} ***\n", defect));
  console().print(fmt::format("{}\n", list.empty() ? "sound" : "NOT SOUND"));
  return list.empty() ? 0 : 1;
}

}  // namespace hardbody
