#include "commands.h"
#include "errors.h"
#include "frame.h"
#include "json_values.h"
#include "observable_files.h"
#include "run_directory.h"
#include "text_file.h"
#include "trajectory_reader.h"
#include "version.h"

#include <ed/stored_frames.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// Bytes of all frames in memory.
constexpr double kMostMemory = 8e9;
constexpr double kMemoryOfABody = 600;

/// What the frames are, and what they are of.
struct Stored {
  std::vector<ed::StoredFrame> frames;
  ed::StoredFramesOptions options;
  std::vector<double> energy;  ///< of each frame; NaN: not known
  std::vector<std::size_t> order;
};

/// The time of a frame.
double time_of(const Frame& frame, std::uint64_t k, const AnalyzeArguments& arguments, const std::string& name) {
  if (arguments.time_step) return static_cast<double>(frame.step) * *arguments.time_step;
  if (std::isfinite(frame.time)) return frame.time;
  throw InputError(fmt::format("{}: frame {} has no time; accepted: --time-step, the time between two steps", name, k));
}

/// Whether a frame's orientations say anything. GSD files hold none where all bodies are aligned: an answer for bodies
/// whose shape is known to have an orientation, for others nobody has looked.
bool says_orientations(const Frame& frame) {
  const auto turned = [](const FrameBody& b) { return b.rotation != Eigen::Matrix3d::Identity(); };
  const auto turnable = [](const FrameType& t) { return t.shape && !ed::is_sphere(*t.shape); };
  return frame.orientations && (std::any_of(frame.bodies.begin(), frame.bodies.end(), turned) ||
                                std::any_of(frame.types.begin(), frame.types.end(), turnable));
}

/// The bodies in the order of their groups, and what each group is.
void read_groups(const Frame& first, Stored& stored) {
  stored.order.resize(first.bodies.size());
  for (std::size_t i = 0; i < stored.order.size(); ++i) stored.order[i] = i;
  std::stable_sort(stored.order.begin(), stored.order.end(),
                   [&](std::size_t a, std::size_t b) { return first.bodies[a].group < first.bodies[b].group; });
  double volume = 0;
  for (std::size_t k = 0; k < stored.order.size(); ++k) {
    const FrameBody& body = first.bodies[stored.order[k]];
    const std::optional<ed::BodyShape>& shape = first.types[body.type].shape;
    if (shape) volume += ed::volume(*shape);
    // As in a run: of revolution if shape and moments are, u the axis of revolution or body z.
    std::optional<int> axis = shape ? ed::symmetry_axis(*shape) : std::nullopt;
    if (axis && first.exact) axis = ed::symmetry_axis(first.exact->species[body.type]);
    stored.options.axis.push_back(axis.value_or(2));
    if (k == 0 || first.bodies[stored.order[k - 1]].group != body.group)
      stored.options.groups.push_back({0, axis ? 2 : 3});
    ++stored.options.groups.back().number;
    if (!axis) stored.options.groups.back().rotation_axes = 3;
  }
  if (volume > 0) {
    stored.options.length = std::cbrt(volume / static_cast<double>(first.bodies.size()) / (4 * std::numbers::pi / 3));
  }
}

ed::StoredFrame stored_frame(const Frame& frame, const Stored& stored, double time) {
  ed::StoredFrame out;
  out.time = time;
  const bool moving =
      std::any_of(frame.bodies.begin(), frame.bodies.end(), [](const FrameBody& b) { return !b.velocity.isZero(0); });
  for (const std::size_t i : stored.order) {
    const FrameBody& body = frame.bodies[i];
    Vector3d position = body.unwrapped;
    // Without images the nearest one to the frame before.
    if (!frame.images && !stored.frames.empty()) {
      const Vector3d before = stored.frames.back().position[out.position.size()];
      const Vector3d d = body.position - before;
      for (int k = 0; k < 3; ++k) position[k] = body.position[k] - frame.box[k] * std::round(d[k] / frame.box[k]);
    }
    out.position.push_back(position);
    out.rotation.push_back(body.rotation);
    if (moving) out.velocity.push_back(body.velocity);
  }
  return out;
}

void check_frame(const Frame& frame, const Frame& first, std::uint64_t k, const std::string& name) {
  const auto refuse = [&](const char* what, const char* accepted) {
    throw InputError(fmt::format("{}: frame {}: {}; accepted: {}", name, k, what, accepted));
  };
  if (const std::optional<std::string> why = not_a_cube(frame)) refuse(why->c_str(), "a cubic box");
  if ((frame.box - first.box).cwiseAbs().maxCoeff() > 1e-6 * first.box.x()) {
    refuse("its box is another one than that of the first frame", "one box");
  }
  if (frame.bodies.size() != first.bodies.size()) refuse("has another number of bodies than the first", "the same");
}

/// What a run has chosen for its own observables.
struct RunChoices {
  std::optional<double> fit_from;    ///< nothing: it has fitted nothing
  std::vector<double> wave_numbers;  ///< of F_self
};

/// Those of the run in that directory, if there is one.
RunChoices choices_of_run(const fs::path& directory) {
  const fs::path file = directory / kSummaryFile;
  RunChoices choices;
  if (!fs::exists(file)) return choices;
  try {
    const Json summary = Json::parse(read_file(file, kLongestSummary));
    for (const char* decay : {"F", "C2"}) {
      const Json& window = summary.at("fit_windows").at(decay);
      if (!window.is_null()) choices.fit_from = window.at(0).get<double>();
    }
    choices.wave_numbers = summary.at("wave_numbers").get<std::vector<double>>();
  } catch (const Json::exception&) {
    throw InputError(
        fmt::format("{}: is not one that a run has written; accepted: a trajectory without such a file "
                    "beside it",
                    file.string()));
  }
  return choices;
}

Stored read_trajectory(const TrajectoryReader& reader, const AnalyzeArguments& arguments) {
  const std::uint64_t count = reader.frame_count();
  if (count == 0) throw InputError(fmt::format("{}: has no whole frame; accepted: a file with frames", reader.name()));
  const Frame first = reader.read(0);
  const auto every = static_cast<std::uint64_t>(arguments.every);
  const double bytes =
      static_cast<double>(first.bodies.size()) * static_cast<double>(count) / arguments.every * kMemoryOfABody;
  if (bytes > kMostMemory) {
    throw InputError(
        fmt::format("{}: {} frames of {} bodies take {:.0f} GB of memory; accepted: at most {:.0f} GB, with "
                    "--every N only each N-th of them",
                    reader.name(), count, first.bodies.size(), bytes / 1e9, kMostMemory / 1e9));
  }
  Stored stored;
  stored.options.box = first.box.x();
  stored.options.longest_lag = arguments.longest_lag.value_or(0);
  read_groups(first, stored);
  bool orientations = false;
  for (std::uint64_t k = 0; k < count; k += every) {
    const Frame frame = reader.read(k);
    check_frame(frame, first, k, reader.name());
    const double time = count == 1 ? 0 : time_of(frame, k, arguments, reader.name());
    stored.frames.push_back(stored_frame(frame, stored, time));
    stored.energy.push_back(frame.energy);
    orientations = orientations || says_orientations(frame);
  }
  if (!orientations) {
    for (ed::StoredFrame& frame : stored.frames) frame.rotation.clear();
  }
  // Frames with and without velocities have them not.
  const auto without = [](const ed::StoredFrame& f) { return f.velocity.empty(); };
  if (std::any_of(stored.frames.begin(), stored.frames.end(), without)) {
    for (ed::StoredFrame& frame : stored.frames) frame.velocity.clear();
  }
  return stored;
}

// ---- Files

std::string cell(double x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "";
}

std::string order_csv(const Stored& stored) {
  std::string text = "t [l sqrt(m/kT)],S [1],energy [kT]\n";
  for (std::size_t k = 0; k < stored.frames.size(); ++k) {
    const ed::StoredFrame& frame = stored.frames[k];
    std::vector<Vector3d> axes;
    for (std::size_t i = 0; i < frame.rotation.size(); ++i) {
      axes.emplace_back(frame.rotation[i].col(stored.options.axis[i]));
    }
    const double S = axes.empty() ? std::numeric_limits<double>::quiet_NaN() : ed::nematic_order(axes);
    text += fmt::format("{},{},{}\n", frame.time, cell(S), cell(stored.energy[k]));
  }
  return text;
}

/// As in summary.json.
Json observables(const ed::Correlations& c, const ed::Estimate& S, const ed::Director& director) {
  Json json;
  json["D_trans"] = estimate_json(c.D_trans);
  json["S"] = estimate_json(S);
  json["director"] = {
      {"value", {number_json(director.axis.x()), number_json(director.axis.y()), number_json(director.axis.z())}},
      {"error", number_json(director.error)}};
  json["tau_C2"] = estimate_json(c.tau_C2);
  json["beta_C2"] = estimate_json(c.beta_C2);
  json["t_C2_1overe"] = estimate_json(c.t_C2_1overe);
  json["tau_F"] = estimate_json(c.tau_F);
  json["beta_F"] = estimate_json(c.beta_F);
  json["t_F_1overe"] = estimate_json(c.t_F_1overe);
  json["q_peak"] = estimate_json(c.q_peak);
  json["S_peak"] = estimate_json(c.S_peak);
  return json;
}

std::string analysis_json(const std::string& name, const Stored& stored, const ed::StoredResults& results) {
  Json json;
  json["version"] = version();
  json["source"] = name;
  json["units"] = "those of the file; of ours kT = m = 1, lengths l, times l sqrt(m/kT)";
  json["frames"] = {{"read", stored.frames.size()}, {"used", results.frames}};
  json["time"] = {{"first", stored.frames.front().time}, {"last", stored.frames[results.frames - 1].time}};
  json["state"] = {{"number", stored.order.size()}, {"box", stored.options.box}, {"length", stored.options.length}};
  json["wave_numbers"] = results.wave_numbers;
  json["fit_from"] = stored.options.fit_from ? Json(*stored.options.fit_from) : Json(nullptr);
  json["observables"] = observables(results, results.S, results.director);
  if (results.groups.size() > 1) {
    for (const ed::GroupResults& group : results.groups)
      json["species"].push_back(observables(group, group.S, group.director));
  }
  return json.dump(2) + "\n";
}

void write_files(const fs::path& out, const std::string& name, const Stored& stored, const ed::StoredResults& results) {
  try {
    fs::create_directories(out);
  } catch (const fs::filesystem_error& error) {
    throw InputError(
        fmt::format("{}: cannot be written to: {}; accepted: a directory", out.string(), error.code().message()));
  }
  const std::array<std::string, kAnalysisFiles.size()> contents = {
      msd_csv(results),    alpha2_csv(results),
      c1_csv(results),     c2_csv(results),
      f_self_csv(results), velocity_csv(results),
      pairs_csv(results),  structure_csv(results),
      order_csv(stored),   analysis_json(name, stored, results)};
  for (std::size_t k = 0; k < contents.size(); ++k) write_file(out / kAnalysisFiles[k], contents[k]);
}

std::string shown(const ed::Estimate& e) {
  return std::isfinite(e.value) ? fmt::format("{:.5g} +- {:.2g}", e.value, e.error) : "-";
}

fs::path trajectory_in(const fs::path& directory) {
  for (const char* name : {kGsdFile, kLammpsFile}) {
    if (fs::exists(directory / name)) return directory / name;
  }
  throw InputError(
      fmt::format("{}: has neither {} nor {}; accepted: the directory of a run with [output] trajectory = [\"gsd\"] or "
                  "[\"lammps\"], or such a file",
                  directory.string(), kGsdFile, kLammpsFile));
}

}  // namespace

int analyze(const AnalyzeArguments& arguments) {
  const fs::path given(arguments.path);
  const fs::path file = fs::is_directory(given) ? trajectory_in(given) : given;
  const fs::path out = arguments.out ? fs::path(*arguments.out) : file.parent_path() / kAnalysisDirectory;
  const std::unique_ptr<TrajectoryReader> source = open_frames(file);
  const TrajectoryReader& reader = *source;
  Stored stored = read_trajectory(reader, arguments);
  const RunChoices run = choices_of_run(file.parent_path());
  stored.options.fit_from = arguments.fit_from ? arguments.fit_from : run.fit_from;
  stored.options.wave_numbers = run.wave_numbers;
  ed::StoredResults results;
  try {
    results = ed::analyze_frames(stored.frames, stored.options);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}{}", reader.name(), one_line(error.what()), reader.cut_off() ? kCutOff : ""));
  }
  write_files(out, reader.name(), stored, results);
  fmt::print("{}: {} frames of {} bodies, {} of them equally far apart in time and used{}\n", reader.name(),
             stored.frames.size(), stored.order.size(), results.frames, reader.cut_off() ? kCutOff : "");
  for (const auto& [name, value] : {std::pair{"D_trans", results.D_trans},
                                    {"S", results.S},
                                    {"t_C2(1/e)", results.t_C2_1overe},
                                    {"tau_C2", results.tau_C2},
                                    {"beta_C2", results.beta_C2},
                                    {"t_F(1/e)", results.t_F_1overe},
                                    {"tau_F", results.tau_F},
                                    {"beta_F", results.beta_F},
                                    {"q_peak", results.q_peak}}) {
    fmt::print("  {:<12} {}\n", name, shown(value));
  }
  if (!stored.options.fit_from)
    fmt::print("no fits of decays: --fit-from T says from which lag, where ballistic motion has ended\n");
  fmt::print("\nfiles: {0}/analysis.json, {0}/*.csv\n", out.string());
  return 0;
}

}  // namespace hardbody
