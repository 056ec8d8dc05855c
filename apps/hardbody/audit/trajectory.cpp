#include "audit/trajectory.h"

#include "audit/pairs.h"
#include "base/console.h"
#include "base/errors.h"
#include "io/text_file.h"
#include "run/record.h"
#include "trajectory/gsd/frames.h"

#include <ed/system.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

/// Findings of all frames together.
struct FramesAudit {
  std::uint64_t frames = 0;             ///< number of frames with positions
  std::uint64_t without_positions = 0;  ///< number of frames that are left out
  std::uint64_t unsound = 0;
  double minimum_distance = std::numeric_limits<double>::infinity();
  std::string closest;  ///< frame and bodies of the smallest distance
  std::uint64_t overlaps = 0;
  std::uint64_t unanswered = 0;
  double tolerance = 0;  ///< largest overlap that is not counted, in the frame with the largest box
  double first_energy = 0;
  double energy_drift = 0;
  double last_time = -std::numeric_limits<double>::infinity();
  std::vector<std::string> not_tested;  ///< each reason once
  std::vector<std::string> notices;     ///< notices of the reader, each once
};

void add_once(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

/// Names bodies by the numbers of the file.
std::string bodies_text(const Frame& frame, std::size_t i, std::size_t j) {
  if (i == j) return fmt::format("body {:.17g} and its own image", frame.bodies[i].id);
  return fmt::format("bodies {:.17g} and {:.17g}", frame.bodies[i].id, frame.bodies[j].id);
}

/// Returns the depth to which bodies in contact may overlap because positions are rounded. 32-bit numbers: half a unit
/// in the last place of a coordinate of each body, and the same for the points on their surfaces. Text has six
/// significant digits by default: 5e-6 of a coordinate of each of the two bodies, along all three axes.
double rounding_of(const Frame& frame, bool text) {
  constexpr auto kEpsilon = static_cast<double>(std::numeric_limits<float>::epsilon());
  constexpr double kSixDigits = 2e-5;
  return (text ? kSixDigits : 4 * kEpsilon) * frame.box.maxCoeff();
}

/// Audits the state itself, which the program's own trajectories contain.
PairAudit audit_exactly(const Frame& frame, const std::string& where, ed::KineticState& kinetic) {
  const ed::Audit audit = audited(*frame.exact, where);
  kinetic = audit.kinetic;
  PairAudit result;
  result.overlaps = static_cast<std::uint64_t>(audit.overlaps);
  result.unanswered = static_cast<std::uint64_t>(audit.unanswered);
  if (!audit.finite) result.not_tested.emplace_back("numbers are not finite");
  if (audit.closest_i < 0) return result;
  result.minimum_distance = audit.minimum_distance;
  result.closest_i = static_cast<std::size_t>(audit.closest_i);
  result.closest_j = static_cast<std::size_t>(audit.closest_j);
  return result;
}

std::vector<std::string> pair_defects(const Frame& frame, const PairAudit& audit) {
  std::vector<std::string> list;
  if (audit.overlaps > 0) {
    list.push_back(fmt::format("{} pairs overlap, the deepest by {:.3g} ({})", audit.overlaps, -audit.minimum_distance,
                               bodies_text(frame, audit.closest_i, audit.closest_j)));
  }
  if (audit.unanswered > 0) {
    list.push_back(fmt::format("{} pairs overlap too deeply for a distance", audit.unanswered));
  }
  return list;
}

/// Adds defects of energy, momentum and time, which only the program's own frames contain exactly.
void add_conservation_defects(const Frame& frame, const ed::KineticState& kinetic, FramesAudit& all,
                              std::vector<std::string>& list) {
  if (all.frames == 1) all.first_energy = kinetic.energy();
  all.energy_drift = std::max(all.energy_drift, std::abs(kinetic.energy() / all.first_energy - 1));
  for (std::string& defect : conservation_defects(kinetic, *frame.exact)) list.push_back(std::move(defect));
  if (!std::isfinite(frame.time)) list.emplace_back("its time is not a number");
  if (!(frame.time > all.last_time)) list.emplace_back("its time is not later than that of the previous frame");
  all.last_time = frame.time;
}

/// Audits a frame and returns its defects, one line each.
std::vector<std::string> audit_frame(const Frame& frame, std::uint64_t k, const std::string& name, bool text,
                                     FramesAudit& all) {
  ++all.frames;
  for (const std::string& notice : frame.notices) add_once(all.notices, notice);
  ed::KineticState kinetic;
  const double tolerance = frame.exact ? 0 : rounding_of(frame, text);
  const PairAudit audit =
      frame.exact ? audit_exactly(frame, fmt::format("{}: frame {}", name, k), kinetic) : audit_pairs(frame, tolerance);
  all.tolerance = std::max(all.tolerance, tolerance);
  all.overlaps += audit.overlaps;
  all.unanswered += audit.unanswered;
  for (const std::string& reason : audit.not_tested) add_once(all.not_tested, reason);
  if (audit.minimum_distance < all.minimum_distance) {
    all.minimum_distance = audit.minimum_distance;
    all.closest = fmt::format("frame {}, {}", k, bodies_text(frame, audit.closest_i, audit.closest_j));
  }
  std::vector<std::string> list = pair_defects(frame, audit);
  if (frame.exact) add_conservation_defects(frame, kinetic, all, list);
  return list;
}

/// Prints the results for the pairs; only exact frames of the program are known to have the unit l.
void print_pairs(const FramesAudit& all, bool exact) {
  const char* unit = exact ? " l" : " (unit of the file)";
  if (all.not_tested.empty()) {
    report_row("overlaps", all.tolerance > 0 ? fmt::format("{}, more than the rounding of the numbers ({:.2g})",
                                                           all.overlaps, all.tolerance)
                                             : fmt::format("{}", all.overlaps));
  } else {
    report_row("overlaps",
               fmt::format("{} found; not tested everywhere: {}", all.overlaps, fmt::join(all.not_tested, "; ")));
  }
  report_row("distances not answered", fmt::format("{}", all.unanswered));
  report_row("minimum distance", std::isfinite(all.minimum_distance)
                                     ? fmt::format("{:.6g}{}, {}", all.minimum_distance, unit, all.closest)
                                 : all.not_tested.empty() ? std::string("no two bounding spheres meet")
                                                          : std::string("not known"));
}

void print_frames(const TrajectoryReader& reader, const Frame& first, const Frame& last, const FramesAudit& all) {
  const auto* gsd = dynamic_cast<const GsdReader*>(&reader);
  const bool exact = first.exact.has_value();
  report_row("written by", gsd != nullptr ? one_line(gsd->application(), 60) : std::string("not stored (LAMMPS dump)"));
  report_row("frames", fmt::format("{}{}", reader.frame_count(), reader.cut_off() ? kCutOff : ""));
  if (all.without_positions > 0) {
    report_row("frames left out", fmt::format("{}, which have no positions", all.without_positions));
  }
  report_row("bodies", fmt::format("{}", first.bodies.size()));
  report_row("bit-exact state", exact ? "yes" : gsd != nullptr ? "no, 32-bit numbers" : "no, rounded decimal numbers");
  if (exact) report_row("times", fmt::format("{:g} to {:g}", first.time, last.time));
  report_row("all numbers finite", "yes");
  print_pairs(all, exact);
  if (exact) {
    report_row("energy drift", fmt::format("{:.1e} (relative, from the first frame)", all.energy_drift));
  } else {
    report_row("energy and momentum", "not tested: not known exactly");
  }
  for (const std::string& notice : all.notices) report_row("notice", notice);
}

}  // namespace

void report_row(const char* name, const std::string& value) {
  console().print(fmt::format("  {:<26} {}\n", name, value));
}

ed::Audit audited(const ed::System& system, const std::string& where) {
  try {
    return ed::audit(system, [] { console().poll(); });
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: holds an impossible state: {}", where, error.what()));
  }
}

int check_trajectory(const TrajectoryReader& reader) {
  constexpr std::uint64_t kMostShown = 20;
  const std::string& name = reader.name();
  const bool text = dynamic_cast<const GsdReader*>(&reader) == nullptr;
  std::string shown;
  Frame first;
  Frame last;
  FramesAudit all;
  for (std::uint64_t k = 0; k < reader.frame_count(); ++k) {
    console().poll();
    if (!reader.has_positions(k)) {
      ++all.without_positions;
      continue;
    }
    last = reader.read(k);
    if (all.frames == 0) first = last;
    const std::vector<std::string> list = audit_frame(last, k, name, text, all);
    if (list.empty()) continue;
    if (++all.unsound > kMostShown) continue;
    for (const std::string& defect : list) shown += fmt::format("  *** NOT SOUND: frame {}: {} ***\n", k, defect);
  }
  if (all.frames == 0) {
    throw InputError(fmt::format("{}: has no complete frame with positions; accepted: a file with frames", name));
  }
  if (all.unsound > kMostShown) shown += fmt::format("  *** and {} more frames ***\n", all.unsound - kMostShown);
  console().print(fmt::format("{}\n{}", name, shown));
  print_frames(reader, first, last, all);
  const std::string reasons = fmt::format("{}", fmt::join(all.not_tested, "; "));
  if (all.unsound > 0) {
    console().print(fmt::format("NOT SOUND\n"));
  } else {
    console().print(fmt::format("{}\n", reasons.empty() ? "sound" : fmt::format("not tested: overlaps: {}", reasons)));
  }
  return all.unsound == 0 && reasons.empty() ? 0 : 1;
}

}  // namespace hardbody
