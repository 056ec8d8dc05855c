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
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// Choices that a run has made for its own observables.
struct RunChoices {
  std::optional<double> fit_from;    ///< nullopt: no fits
  std::vector<double> wave_numbers;  ///< wave numbers of F_self
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
    for (const char* decay : {"F", "C2"}) {
      const Json& window = summary.at("fit_windows").at(decay);
      if (!window.is_null()) choices.fit_from = window.at(0).get<double>();
    }
    choices.wave_numbers = summary.at("wave_numbers").get<std::vector<double>>();
    const auto positive = [](double q) { return q > 0 && std::isfinite(q); };
    const bool valid = choices.wave_numbers.size() <= ed::kMostWaveNumbers && choices.fit_from.value_or(0) >= 0;
    if (valid && std::all_of(choices.wave_numbers.begin(), choices.wave_numbers.end(), positive)) return choices;
  } catch (const Json::exception&) {
    throw foreign;
  }
  throw foreign;
}

// ---- Files

std::string cell(double x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "";
}

std::string order_csv(const StoredTrajectory& stored, Units units) {
  std::string text = fmt::format("{},S [1],energy [{}]\n", abscissa_of(Rows::lags, units), unit_text("kT", units));
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
                          Units units) {
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
  json["time"] = {{"first", stored.frames[results.first_frame].time}, {"last", stored.frames[last].time}};
  json["unwrapped"] = {{"by", text_or_null(stored.unwrapped_by)}, {"reason", text_or_null(stored.not_unwrapped)}};
  json["followed"] = {{"by", stored.not_followed.empty() ? Json("ids") : Json(nullptr)},
                      {"reason", text_or_null(stored.not_followed)}};
  json["notices"] = stored.notices;
  json["state"] = {
      {"number", stored.options.axis.size()}, {"box", stored.options.box}, {"length", stored.options.length}};
  json["wave_numbers"] = results.wave_numbers;
  json["fit_from"] = stored.options.fit_from ? Json(*stored.options.fit_from) : Json(nullptr);
  json["observables"] = frame_observables({results, &results});
  if (results.groups.size() > 1) {
    for (const ed::GroupResults& group : results.groups) json["species"].push_back(frame_observables({group}));
  }
  return json.dump(2) + "\n";
}

void write_files(const fs::path& out, const std::string& name, const StoredTrajectory& stored,
                 const ed::StoredResults& results, Units units) {
  try {
    fs::create_directories(out);
  } catch (const fs::filesystem_error& error) {
    throw InputError(
        fmt::format("{}: cannot be written to: {}; accepted: a directory", out.string(), error.code().message()));
  }
  for (const CurveFile& file : curve_files()) {
    if (file.in_frames) write_file(out / (file.name + ".csv"), curve_csv(file, results, units));
  }
  write_file(out / kOrderFile, order_csv(stored, units));
  write_file(out / kAnalysisFile, analysis_json(name, stored, results, units));
}

std::string shown(const ed::Estimate& e) {
  if (!std::isfinite(e.value)) return fmt::format("- ({})", missing_text(e.missing, kWords));
  if (!std::isfinite(e.error)) return fmt::format("{:.5g} (no error)", e.value);
  return fmt::format("{:.5g} +- {:.2g}", e.value, e.error);
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

}  // namespace

int analyze(const AnalyzeArguments& arguments) {
  const fs::path given(arguments.path);
  const fs::path file = fs::is_directory(given) ? trajectory_in(given) : given;
  const fs::path out = arguments.out ? fs::path(*arguments.out) : file.parent_path() / kAnalysisDirectory;
  const std::unique_ptr<TrajectoryReader> source = open_frames(file);
  const TrajectoryReader& reader = *source;
  StoredTrajectory stored = read_trajectory(reader, {arguments.every, arguments.time_step, arguments.longest_lag});
  const RunChoices run = choices_of_run(file.parent_path());
  stored.options.fit_from = arguments.fit_from ? arguments.fit_from : run.fit_from;
  stored.options.wave_numbers = run.wave_numbers;
  const bool of_the_run = file.filename() == kGsdFile || file.filename() == kLammpsFile;
  if (!of_the_run && !run.wave_numbers.empty()) {
    stored.notices.push_back(
        fmt::format("wave numbers of F_self are those of {}", (file.parent_path() / kSummaryFile).string()));
  }
  const ed::StoredResults results = ed::analyze_frames(stored.frames, stored.options);
  const bool known_units = stored.exact || (of_the_run && fs::exists(file.parent_path() / kSummaryFile));
  write_files(out, reader.name(), stored, results, known_units ? Units::of_runs : Units::unknown);
  print_reading(reader, stored, results);
  for (const Observable& o : observables()) {
    if (!o.in_frames || o.label.empty()) continue;
    for (const ed::Estimate& value : numbers_of(o, {results, &results})) {
      console().print(fmt::format("  {:<12} {}\n", o.label, shown(value)));
    }
  }
  if (!stored.options.fit_from)
    console().print("no fits of decays: --fit-from T sets the first lag, where ballistic motion has ended\n");
  console().print(fmt::format("\nfiles: {0}/analysis.json, {0}/*.csv\n", out.string()));
  return 0;
}

}  // namespace hardbody
