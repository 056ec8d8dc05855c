#include "base/console.h"
#include "base/errors.h"
#include "base/version.h"
#include "commands/commands.h"
#include "io/json_values.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "run/files/observable_files.h"
#include "run/missing.h"
#include "run/observables_json.h"
#include "run/table.h"
#include "trajectory/frame.h"
#include "trajectory/reader.h"
#include "trajectory/stored_trajectory.h"

#include <ed/stored_frames.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// Choices that a run has made for its own observables.
struct RunChoices {
  std::optional<double> fit_from;    ///< nullopt: not known
  std::string fit_from_by;           ///< source of it
  std::vector<double> wave_numbers;  ///< wave numbers of F_self
  bool collective = false;           ///< whether the run measured F(q, t) / S(q)
  int order_neighbours = 12;         ///< number of neighbours of bond order
};

/// Returns those of the run in this directory, if there is one.
RunChoices choices_of_run(const fs::path& directory) {
  const fs::path file = directory / kSummaryFile;
  RunChoices choices;
  if (!fs::exists(file)) return choices;
  const InputError foreign(
      fmt::format("{}: was not written by a run; accepted: a trajectory without such a file beside it", file.string()));
  try {
    const Json summary = Json::parse(read_file(file, kLongestSummary));
    const Json& rate = summary.at("observables").at("collision_rate").at("value");
    if (!rate.is_null() && rate.get<double>() > 0) {
      choices.fit_from = ed::kBallisticCollisions / rate.get<double>();
      choices.fit_from_by = "five mean collision intervals of the run";
    }
    for (const char* decay : {"F", "C2"}) {
      const Json& window = summary.at("fit_windows").at(decay);
      if (window.is_null()) continue;
      choices.fit_from = window.at(0).get<double>();
      choices.fit_from_by = "the first lag of the run's own fit";
    }
    choices.wave_numbers = summary.at("wave_numbers").get<std::vector<double>>();
    choices.collective = summary.value("collective", false);
    if (summary.contains("order_neighbours")) choices.order_neighbours = summary["order_neighbours"].get<int>();
    const auto positive = [](double q) { return q > 0 && std::isfinite(q); };
    const bool valid = choices.wave_numbers.size() <= ed::kMostWaveNumbers &&
                       choices.order_neighbours >= ed::kFewestNeighbours &&
                       choices.order_neighbours <= ed::kMostNeighbours && choices.fit_from.value_or(0) >= 0;
    if (valid && std::all_of(choices.wave_numbers.begin(), choices.wave_numbers.end(), positive)) return choices;
  } catch (const Json::exception&) {
    throw foreign;
  }
  throw foreign;
}

constexpr const char* kByDisplacements = "the MSD grows as t^1.5 or more slowly there";

// ---- Files

std::string cell(double x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "";
}

/// Axes of the bodies that have an orientation; of all, if none has.
std::vector<Vector3d> axes_of(const ed::StoredFrame& frame, const ed::StoredFramesOptions& options) {
  const bool some = std::any_of(options.groups.begin(), options.groups.end(), [](const auto& g) { return g.oriented; });
  std::vector<Vector3d> axes;
  std::size_t i = 0;
  for (const ed::BodyGroup& group : options.groups) {
    for (const std::size_t end = i + static_cast<std::size_t>(group.number); i < end; ++i) {
      if (frame.rotation.empty() || (some && !group.oriented)) continue;
      axes.emplace_back(frame.rotation[i].col(options.axis[i]));
    }
  }
  return axes;
}

std::string order_csv(const StoredTrajectory& stored, Units units) {
  std::string text = fmt::format("{},S [1],energy [{}]\n", abscissa_of(Rows::lags, units), unit_text("kT", units));
  for (std::size_t k = 0; k < stored.frames.size(); ++k) {
    const ed::StoredFrame& frame = stored.frames[k];
    const std::vector<Vector3d> axes = axes_of(frame, stored.options);
    const double S = axes.empty() ? std::numeric_limits<double>::quiet_NaN() : ed::nematic_order(axes);
    text += fmt::format("{},{},{}\n", frame.time, cell(S), cell(stored.energy[k]));
  }
  return text;
}

/// Words for missing values: lengths have the unit of the file.
const MissingWords kWords = {"", "--longest-lag or a longer trajectory helps", "--fit-from sets it",
                             "unwrapped columns, image flags or frames closer together help", "a column id helps"};

/// Returns the entries of summary.json that frames tell. A director that is missing is a list of nulls.
Json frame_observables(const Part& part) {
  Json json = observables_json(part, kWords, Source::frames);
  if (!part.results.director.axis.allFinite()) json["director"]["value"] = list_json(part.results.director.axis);
  return json;
}

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

std::string analysis_json(const std::string& name, const StoredTrajectory& stored, const ed::StoredResults& results,
                          const std::string& fit_from_by, Units units) {
  Json json;
  json["version"] = version();
  json["source"] = name;
  json["units"] = units == Units::of_runs ? "kT = m = 1, lengths l, times l sqrt(m/kT)" : "those of the file";
  const std::size_t last = results.first_frame + results.frames - 1;
  json["frames"] = {{"in_file", stored.in_file},
                    {"without_positions", stored.without_positions},
                    {"read", stored.frames.size()},
                    {"used", results.frames},
                    {"first_used", results.first_frame}};
  json["log_times"] = results.log_times;
  json["time"] = {{"first", stored.frames[results.first_frame].time}, {"last", stored.frames[last].time}};
  json["unwrapped"] = {{"by", text_or_null(stored.unwrapped_by)}, {"reason", text_or_null(stored.not_unwrapped)}};
  json["followed"] = {{"by", stored.not_followed.empty() ? Json("ids") : Json(nullptr)},
                      {"reason", text_or_null(stored.not_followed)}};
  json["notices"] = stored.notices;
  json["state"] = {
      {"number", stored.options.axis.size()}, {"box", stored.options.box}, {"length", stored.options.length}};
  json["wave_numbers"] = results.wave_numbers;
  json["van_hove_lags"] = results.displacement_lags;
  json["fit_from"] = number_json(results.fit_from);
  json["fit_from_by"] = text_or_null(fit_from_by);
  json["observables"] = frame_observables({results, &results});
  if (results.groups.size() > 1) {
    for (const ed::GroupResults& group : results.groups) json["species"].push_back(frame_observables({group}));
  }
  return json.dump(2) + "\n";
}

void write_files(const fs::path& out, const std::string& name, const StoredTrajectory& stored,
                 const ed::StoredResults& results, const std::string& fit_from_by, Units units) {
  try {
    fs::create_directories(out);
  } catch (const fs::filesystem_error& error) {
    throw InputError(
        fmt::format("{}: cannot be written to: {}; accepted: a directory", out.string(), error.code().message()));
  }
  for (const CurveFile& file : curve_files()) {
    if (file.in_frames && is_written(file, results))
      write_file(out / (file.name + ".csv"), curve_csv(file, results, units));
  }
  write_file(out / kOrderFile, order_csv(stored, units));
  write_file(out / kAnalysisFile, analysis_json(name, stored, results, fit_from_by, units));
}

std::string shown(const ed::Estimate& e) {
  if (!std::isfinite(e.value)) return fmt::format("- ({})", missing_text(e.missing, kWords));
  if (!std::isfinite(e.error)) return fmt::format("{:.5g} (no error)", e.value);
  return fmt::format("{:.5g} +- {:.2g}", e.value, e.error);
}

/// Refuses a longest lag that no two frames have.
void check_lag(const std::optional<double>& lag, const std::vector<ed::StoredFrame>& frames) {
  const double span = frames.back().time - frames.front().time;
  if (!lag || frames.size() < 2 || *lag <= span * (1 + 1e-9)) return;
  throw InputError(fmt::format(
      "--longest-lag is {:g}; accepted: at most the time between the first and the last frame, {:g}", *lag, span));
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

/// Prints what was read, and which of it was not used.
void print_reading(const TrajectoryReader& reader, const StoredTrajectory& stored, const ed::StoredResults& results) {
  console().print(fmt::format("{}: {} {} of {} bodies{}\n", reader.name(), stored.frames.size(),
                              stored.frames.size() == 1 ? "frame" : "frames", stored.options.axis.size(),
                              reader.cut_off() ? kCutOff : ""));
  const auto note = [](const std::string& text) { console().print(fmt::format("  note: {}\n", text)); };
  if (stored.without_positions > 0) {
    note(fmt::format("frames without positions are left out: {} of {} in the file", stored.without_positions,
                     stored.in_file));
  }
  if (results.log_times) {
    note("frames at logarithmic times: each is correlated with the first one, so that values have no errors");
  }
  if (results.frames < stored.frames.size()) {
    note(fmt::format(
        "S, g(r) and S(q) are from all frames, correlations from the longest evenly spaced sequence, {} frames "
        "of times {:g} to {:g}",
        results.frames, stored.frames[results.first_frame].time,
        stored.frames[results.first_frame + results.frames - 1].time));
  }
  for (const std::string& notice : stored.notices) note(notice);
  if (!stored.not_followed.empty()) {
    note(fmt::format("no correlations in time: {}", stored.not_followed));
  } else if (!stored.not_unwrapped.empty()) {
    note(fmt::format("no displacements, MSD and F_self: {}", stored.not_unwrapped));
  } else if (stored.frames.size() > 1) {
    console().print(fmt::format("  positions unwrapped by {}\n", stored.unwrapped_by));
  }
}

/// Prints the lines of an observable; none of directions where bodies move alike in all of them.
void print_observable(const Observable& observable, const Part& part) {
  const bool directed = observable.of_box || observable.key == "director";
  if (directed && observable.remark(part).empty()) return;
  if (const auto* director = std::get_if<ed::Director ed::GroupResults::*>(&observable.value)) {
    console().print(fmt::format("  {:<12} {}\n", observable.label, format_director(part.results.**director)));
  }
  const std::vector<ed::Estimate> numbers = numbers_of(observable, part);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const ed::MissingReason reason = numbers[k].missing.reason;
    const bool no_order = reason == ed::MissingReason::no_director || reason == ed::MissingReason::no_bragg_peak;
    if (is_absent(numbers[k]) || (!std::isfinite(numbers[k].value) && no_order)) continue;
    console().print(fmt::format("  {:<12} {}\n", label_of(observable, k), shown(numbers[k])));
  }
}

}  // namespace

int analyze(const AnalyzeArguments& arguments) {
  const fs::path given(arguments.path);
  const fs::path file = fs::is_directory(given) ? trajectory_in(given) : given;
  const fs::path out = arguments.out ? fs::path(*arguments.out) : file.parent_path() / kAnalysisDirectory;
  const std::unique_ptr<TrajectoryReader> source = open_frames(file);
  const TrajectoryReader& reader = *source;
  StoredTrajectory stored = read_trajectory(reader, {arguments.every, arguments.time_step, arguments.longest_lag});
  check_lag(arguments.longest_lag, stored.frames);
  RunChoices run = choices_of_run(file.parent_path());
  if (arguments.fit_from) {
    run.fit_from = arguments.fit_from;
    run.fit_from_by = "as asked for";
  }
  stored.options.fit_from = run.fit_from;
  stored.options.wave_numbers = run.wave_numbers;
  stored.options.collective = arguments.collective || run.collective;
  const bool of_the_run = file.filename() == kGsdFile || file.filename() == kLammpsFile;
  if (!of_the_run && !run.wave_numbers.empty()) {
    stored.notices.push_back(
        fmt::format("wave numbers of F_self are those of {}", (file.parent_path() / kSummaryFile).string()));
  }
  stored.options.bonds = {true, run.order_neighbours, true};
  stored.options.poll = [] { console().poll(); };
  const ed::StoredResults results = ed::analyze_frames(stored.frames, stored.options);
  if (!run.fit_from && std::isfinite(results.fit_from)) run.fit_from_by = kByDisplacements;
  const bool known_units = stored.exact || (of_the_run && fs::exists(file.parent_path() / kSummaryFile));
  write_files(out, reader.name(), stored, results, run.fit_from_by, known_units ? Units::of_runs : Units::unknown);
  print_reading(reader, stored, results);
  for (const Observable& o : observables()) {
    if (!o.in_frames || o.label.empty()) continue;
    print_observable(o, {results, &results});
  }
  console().print(std::isfinite(results.fit_from)
                      ? fmt::format("decays are fitted from lag {:.4g} on: {}\n", results.fit_from, run.fit_from_by)
                      : "no fits of decays: --fit-from T sets the first lag, where ballistic motion has ended\n");
  console().print(fmt::format("\nfiles: {0}/analysis.json, {0}/*.csv\n", out.string()));
  return 0;
}

}  // namespace hardbody
