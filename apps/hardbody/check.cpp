#include "agreement.h"
#include "checkpoint.h"
#include "commands.h"
#include "config.h"
#include "errors.h"
#include "gsd_frames.h"
#include "run_directory.h"
#include "run_record.h"
#include "table.h"
#include "text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

void row(const char* name, const std::string& value) {
  fmt::print("  {:<26} {}\n", name, value);
}

std::string yes_or_no(bool yes) {
  return yes ? "yes" : "NO";
}

ed::Audit audit(const ed::System& system, const std::string& name) {
  try {
    return ed::audit(system);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: holds an impossible state: {}", name, error.what()));
  }
}

void print_state(const Checkpoint& checkpoint, const ed::Audit& audit) {
  const ed::KineticState& kinetic = audit.kinetic;
  row("state at", fmt::format("time {:g} of {}, written by hardbody {}", checkpoint.time, checkpoint.phase,
                              checkpoint.program_version));
  row("bodies", fmt::format("{}", checkpoint.system.size()));
  row("all numbers finite", yes_or_no(audit.finite));
  row("overlaps", fmt::format("{}", audit.overlaps));
  row("distances not answered", fmt::format("{}", audit.unanswered));
  row("minimum distance", audit.closest_i < 0 ? std::string("no two bounding spheres meet")
                                              : fmt::format("{:.6g} l, bodies {} and {}", audit.minimum_distance,
                                                            audit.closest_i, audit.closest_j));
  row("energy", fmt::format("{:.10g} kT (translation {:.6g}, rotation {:.6g}, spin {:.6g})", kinetic.energy(),
                            kinetic.translational_energy, kinetic.rotational_energy, kinetic.spin_energy));
  row("translational temperature", fmt::format("{:.6f} on 3N - 3 degrees of freedom", kinetic.translational_kT));
  row("rotational temperature", fmt::format("{:.6f} on {}", kinetic.rotational_kT,
                                            freedoms_text(kinetic.rotational_freedoms, checkpoint.system.size())));
  row("momentum", fmt::format("{:.2e} sqrt(m kT) a body", kinetic.momentum.norm() / checkpoint.system.size()));
}

/// Whether the state is that of the config it was made with.
bool print_config(const Checkpoint& checkpoint, const std::string& name) {
  const Config config = parse_config(checkpoint.config, name + " (its config)");
  const double phi = ed::packing_fraction(checkpoint.system);
  const bool same_phi = std::abs(phi / config.packing_fraction - 1) < kStateRounding;
  const Agreement same = compare(checkpoint.system, config);
  row("packing fraction", fmt::format("{:.15g}, as configured: {}", phi, yes_or_no(same_phi)));
  row("number as configured", yes_or_no(same.number));
  row("shape as configured", yes_or_no(same.shape));
  row("inertia as configured", yes_or_no(same.dynamics));
  return same_phi && same.number && same.shape && same.dynamics;
}

// ---- Trajectories

/// What all frames together show.
struct FramesAudit {
  std::uint64_t unsound = 0;
  double minimum_distance = std::numeric_limits<double>::infinity();
  std::uint64_t closest_frame = 0;
  std::uint64_t overlaps = 0;
  std::uint64_t unanswered = 0;
  double first_energy = 0;
  double energy_drift = 0;
  bool shapes = true;  ///< of all bodies are known
};

/// The bodies of a frame, without the doubles of its state; nothing if a shape is missing.
std::optional<ed::System> rounded_system(const Frame& frame) {
  ed::System system;
  system.box = frame.box.x();
  for (const FrameType& type : frame.types) {
    if (!type.shape) return std::nullopt;
    system.species.emplace_back().shape = *type.shape;
  }
  for (const FrameBody& body : frame.bodies) {
    system.bodies.push_back(
        {body.position, body.rotation, body.velocity, body.angular_velocity, static_cast<int>(body.type)});
  }
  return system;
}

/// Where positions are 32-bit numbers bodies in contact overlap by so much: half a unit in the last place of a
/// coordinate of each body, and as much of the points on their surfaces.
bool overlaps(const Frame& frame, const ed::Audit& audit) {
  constexpr auto kEpsilon = static_cast<double>(std::numeric_limits<float>::epsilon());
  if (audit.unanswered > 0) return true;
  return frame.exact ? audit.overlaps > 0 : audit.minimum_distance < -4 * kEpsilon * frame.box.maxCoeff();
}

/// What is wrong with a frame, one line each.
std::vector<std::string> audit_frame(const Frame& frame, std::uint64_t k, const std::string& name, FramesAudit& all) {
  const bool cube = !not_a_cube(frame);
  const std::optional<ed::System> system = frame.exact ? frame.exact : cube ? rounded_system(frame) : std::nullopt;
  all.shapes = all.shapes && system;
  if (!system) return {};
  const ed::Audit result = audit(*system, fmt::format("{}: frame {}", name, k));
  std::vector<std::string> list;
  if (result.closest_i >= 0 && result.minimum_distance < all.minimum_distance) {
    all.minimum_distance = result.minimum_distance;
    all.closest_frame = k;
  }
  if (overlaps(frame, result)) {
    all.overlaps += static_cast<std::uint64_t>(result.overlaps);
    all.unanswered += static_cast<std::uint64_t>(result.unanswered);
    list = defects(result);
  }
  if (!frame.exact) return list;
  if (k == 0) all.first_energy = result.kinetic.energy();
  all.energy_drift = std::max(all.energy_drift, std::abs(result.kinetic.energy() / all.first_energy - 1));
  for (std::string& defect : conservation_defects(result.kinetic, *system)) list.push_back(std::move(defect));
  if (!std::isfinite(frame.time)) list.emplace_back("its time is not a number");
  return list;
}

void print_frames(const GsdReader& reader, const Frame& first, const Frame& last, const FramesAudit& all) {
  row("written by", fmt::format("{}", one_line(reader.application(), 60)));
  row("frames", fmt::format("{}{}", reader.frame_count(), reader.cut_off() ? kCutOff : ""));
  row("bodies", fmt::format("{}", first.bodies.size()));
  row("state to every bit", reader.exact() ? "yes" : "no, 32-bit numbers");
  if (reader.exact()) row("times", fmt::format("{:g} to {:g}", first.time, last.time));
  row("all numbers finite", "yes");
  row("overlaps", all.shapes ? fmt::format("{}", all.overlaps) : "not looked for: a shape is missing, or no cube");
  if (all.shapes) row("distances not answered", fmt::format("{}", all.unanswered));
  if (std::isfinite(all.minimum_distance)) {
    row("minimum distance", fmt::format("{:.6g} l, frame {}", all.minimum_distance, all.closest_frame));
  }
  if (reader.exact()) row("energy drift", fmt::format("{:.1e} (relative, from the first frame)", all.energy_drift));
}

int check_trajectory(const std::string& path) {
  constexpr std::uint64_t kMostShown = 20;
  const GsdReader reader{fs::path(path)};
  if (reader.frame_count() == 0) {
    throw InputError(fmt::format("{}: has no whole frame; accepted: a file with frames", path));
  }
  std::string shown;
  const Frame first = reader.read(0);
  Frame last = first;
  FramesAudit all;
  for (std::uint64_t k = 0; k < reader.frame_count(); ++k) {
    const double before = last.time;
    if (k > 0) last = reader.read(k);
    std::vector<std::string> list = audit_frame(last, k, path, all);
    if (k > 0 && reader.exact() && !(last.time > before))
      list.emplace_back("its time is not after that of the one before");
    if (list.empty()) continue;
    if (++all.unsound > kMostShown) continue;
    for (const std::string& defect : list) shown += fmt::format("  *** NOT SOUND: frame {}: {} ***\n", k, defect);
  }
  if (all.unsound > kMostShown) shown += fmt::format("  *** and {} more frames ***\n", all.unsound - kMostShown);
  fmt::print("{}\n{}", path, shown);
  print_frames(reader, first, last, all);
  fmt::print("{}\n", all.unsound == 0 ? "sound" : "NOT SOUND");
  return all.unsound == 0 ? 0 : 1;
}

}  // namespace

int check(const std::string& path) {
  if (fs::path(path).extension() == ".gsd" && !fs::is_directory(path)) return check_trajectory(path);
  if (!fs::is_directory(path)) {
    throw InputError(
        fmt::format("{}: is {}; accepted: a run directory", path, fs::exists(path) ? "not a directory" : "not there"));
  }
  const fs::path file = fs::path(path) / kCheckpointFile;
  const Checkpoint checkpoint = read_checkpoint(file);
  const ed::Audit result = audit(checkpoint.system, file.string());
  fmt::print("{}\n", file.string());
  print_state(checkpoint, result);
  std::vector<std::string> list = defects(result);
  for (std::string& defect : conservation_defects(result.kinetic, checkpoint.system)) list.push_back(std::move(defect));
  if (!print_config(checkpoint, file.string())) list.emplace_back("the state is not that of its config");
  for (const std::string& defect : list) fmt::print("  *** NOT SOUND: {} ***\n", defect);
  fmt::print("{}\n", list.empty() ? "sound" : "NOT SOUND");
  return list.empty() ? 0 : 1;
}

}  // namespace hardbody
