#include "report/run.h"

#include "base/errors.h"
#include "base/find.h"
#include "base/shapes.h"
#include "config/shape_forms.h"
#include "io/json_member.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "run/checkpoint.h"
#include "trajectory/gsd/frames.h"

#include <fmt/format.h>

#include <array>
#include <numeric>
#include <utility>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestText = std::size_t{1} << 26;
/// Bytes of the log that are shown, from its end, which is the most informative part.
constexpr std::size_t kLogShown = 30'000;

nlohmann::json read_summary(const fs::path& path) {
  if (!fs::exists(path)) return nullptr;
  try {
    nlohmann::json summary = parse_json(read_file(path, kLongestText));
    if (!summary.is_object()) throw JsonError("is not an object");
    return summary;
  } catch (const JsonError& error) {
    throw InputError(fmt::format("{}: {}; accepted: the summary of a run", path.string(), error.what()));
  }
}

std::string read_log(const fs::path& path) {
  if (!fs::exists(path)) return "";
  std::string log = read_file(path, kLongestText);
  if (log.size() <= kLogShown) return log;
  const std::size_t line = log.find('\n', log.size() - kLogShown);
  return "...\n" + log.substr(line == std::string::npos ? log.size() - kLogShown : line + 1);
}

bool says(const nlohmann::json& json, bool wanted) {
  return json.is_boolean() && json.get<bool>() == wanted;
}

double number_of(const nlohmann::json& json) {
  return json.is_number() ? json.get<double>() : 0;
}

/// Returns a remark on how far the run came.
Remark completion(const nlohmann::json& summary) {
  using Kind = Remark::Kind;
  const nlohmann::json& time = member(summary, "time");
  const double production = number_of(member(time, "production"));
  if (member(summary, "stalled").is_string()) {
    return {Kind::bad, "stalled", "The run made no progress and was ended: " + summary["stalled"].get<std::string>()};
  }
  if (!says(member(summary, "interrupted"), true)) {
    return {Kind::good, "complete", fmt::format("The run is complete: {:g} time units of production.", production)};
  }
  return {
      Kind::warning, "stopped early",
      production > 0
          ? fmt::format("The run was stopped {:g} time units into production: all numbers are from that part. "
                        "hardbody resume continues it.",
                        production)
          : fmt::format("The run was stopped {:g} time units into its equilibration: nothing has been measured yet. "
                        "hardbody resume continues it.",
                        number_of(member(time, "equilibration")))};
}

Remark soundness(const nlohmann::json& summary) {
  using Kind = Remark::Kind;
  const nlohmann::json& counters = member(summary, "counters");
  if (says(member(summary, "sound"), true)) {
    return {Kind::good, "sound", "No overlap, nothing missed, energy and momentum conserved to rounding."};
  }
  return {
      Kind::bad, "not sound",
      fmt::format("Do not use these results: the audit failed ({:g} overlaps during the run, {:g} pairs that no method "
                  "answered); log.txt and hardbody check say what is wrong.",
                  number_of(member(counters, "overlaps")), number_of(member(counters, "declined")))};
}

std::vector<Remark> remarks_of(const nlohmann::json& summary) {
  using Kind = Remark::Kind;
  std::vector<Remark> list = {completion(summary), soundness(summary)};
  const double equilibration = number_of(member(member(summary, "time"), "equilibration"));
  if (says(member(summary, "equilibrated"), true)) {
    list.push_back(
        {Kind::good, "equilibrated",
         member(summary, "equilibrated_by") == "stationarity"
             ? fmt::format("Order and pressure of this nematic or crystal were stationary over the last two "
                           "thirds of {:g} time units.",
                           equilibration)
             : fmt::format("C2 and F_self decayed below 0.05 twice in a row within {:g} time units.", equilibration)});
  } else {
    list.push_back({Kind::warning, "not shown to be equilibrated",
                    fmt::format("In {:g} time units C2 and F_self did not decay below 0.05 twice in a row, nor was "
                                "the order of a nematic or a crystal stationary: the time is too short, or the state "
                                "is a glass or has domains.",
                                equilibration)});
  }
  const nlohmann::json& target = member(summary, "target_error");
  if (says(member(target, "reached"), false)) {
    list.push_back({Kind::warning, "errors larger than asked",
                    fmt::format("The diffusion coefficients have not both reached a relative error of {:g}.",
                                number_of(member(target, "asked")))});
  }
  const nlohmann::json& failures = member(summary, "failures");
  const double failed = number_of(member(failures, "recorded")) + number_of(member(failures, "left_out"));
  if (failed > 0) {
    list.push_back({Kind::warning, fmt::format("{:g} pairs in failures/", failed),
                    "The configured method could not predict them; hardbody replay shows them."});
  }
  return list;
}

/// State that can be shown, with its time.
struct Seen {
  View view;
  std::string phase = "production";
  bool cut_off = false;  ///< whether an incomplete last frame is left out
};

/// Reads the stored frames; nullopt if there is at most one.
std::optional<Seen> read_trajectory(const fs::path& path) {
  if (!fs::exists(path)) return std::nullopt;
  const GsdReader reader(path);
  if (reader.frame_count() < 2) return std::nullopt;
  const std::size_t number = reader.read(0).bodies.size();
  const auto read = [&](std::size_t k) {
    Frame frame = reader.read(k);
    if (frame.bodies.size() == number) return frame;
    throw InputError(fmt::format("{}: frame {} has {} bodies; accepted: {}, as in the first", path.string(), k,
                                 frame.bodies.size(), number));
  };
  Seen seen{view_of({reader.frame_count(), read})};
  seen.cut_off = reader.cut_off();
  return seen;
}

/// Calls `read`. If a part cannot be shown, the report is still made: a remark gives the reason.
template <class Read>
std::optional<Seen> if_readable(const Read& read, const char* what, std::vector<Remark>& remarks) {
  try {
    return read();
  } catch (const InputError& error) {
    remarks.push_back({Remark::Kind::warning, fmt::format("{} not shown", what), one_line(error.what())});
    return std::nullopt;
  }
}

/// Reads the last state.
std::optional<Seen> read_last_state(const fs::path& path, const Config& config) {
  if (!fs::exists(path)) return std::nullopt;
  const Checkpoint checkpoint = read_checkpoint(path);
  const std::vector<int> numbers = config.numbers();
  if (std::accumulate(numbers.begin(), numbers.end(), 0) != checkpoint.system.size()) {
    throw InputError(fmt::format("{}: holds {} bodies, the config {}; accepted: the checkpoint of its config",
                                 path.string(), checkpoint.system.size(), config.number));
  }
  Frame frame = frame_of(checkpoint.system, numbers);
  frame.time = checkpoint.time;
  Seen seen{view_of({1, [&](std::size_t /*k*/) { return frame; }}), checkpoint.phase};
  return seen;
}

Remark unfinished(const std::optional<Seen>& seen) {
  using Kind = Remark::Kind;
  if (!seen) return {Kind::warning, "unfinished", "The run has no results yet, nor a checkpoint."};
  return {Kind::warning, "unfinished",
          fmt::format("The run has no results yet; the last state that was stored is of {} at time {:g}.", seen->phase,
                      seen->view.frames.back().time)};
}

/// Returns "ellipsoids, X0 = 3", "superballs, p = 4".
std::string bodies_title(const SpeciesConfig& species) {
  const ShapeForm& form = form_of(species.shape.kind);
  if (form.title != nullptr) return form.title(species.shape);
  const ShapeNumbers numbers = numbers_of(species.body.shape);
  const Eigen::Vector3d& a = numbers.lengths;
  const Eigen::Vector2d& e = numbers.exponents;
  const ShapeKind kind = numbers.kind;
  const std::string name = plural(kind);
  const double least = a.minCoeff();
  const std::string ratios = fmt::format("{:.4g} : {:.4g} : {:.4g}", a.x() / least, a.y() / least, a.z() / least);
  if (has_exponents(kind)) {
    const bool superballs = a.x() == a.y() && a.y() == a.z() && e.x() == e.y();
    return superballs ? fmt::format("superballs, p = {:.4g}", 2 / e.x())
                      : fmt::format("{} {}, exponents {:g} and {:g}", name, ratios, e.x(), e.y());
  }
  const std::optional<double> ratio = species.shape.true_aspect_ratio();
  if (!ratio) return fmt::format("{} {}", name, ratios);
  return *ratio == 1 ? std::string("spheres") : fmt::format("{}, X₀ = {:.4g}", name, *ratio);
}

/// Returns the title of a species with the spread of its sizes.
std::string sized_title(const SpeciesConfig& species) {
  std::string title = bodies_title(species);
  if (!species.sizes) return title;
  return fmt::format("{}, {} sizes of width {:.3g}", title, ed::to_string(*species.sizes), species.width);
}

/// Returns the numbers of each species, if there are several: those of a single one are the run's.
std::vector<SpeciesReport> species_of(const Config& config, const nlohmann::json& summary) {
  std::vector<SpeciesReport> list;
  const nlohmann::json& all = member(summary, "species");
  if (config.species.size() < 2) return list;
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    SpeciesReport species;
    species.title = fmt::format("{} {}", config.species[k].number, sized_title(config.species[k]));
    species.oriented = !is_sphere(config.species[k]);
    if (all.is_array() && k < all.size()) {
      species.headlines = headlines_of(member(all[k], "observables"), species.oriented);
    }
    list.push_back(std::move(species));
  }
  return list;
}

}  // namespace

const char* to_string(Remark::Kind kind) {
  return std::array{"good", "warning", "bad"}[static_cast<std::size_t>(kind)];
}

const nlohmann::json& member(const nlohmann::json& json, const char* key) {
  static const nlohmann::json kNothing;
  const auto place = json.find(key);
  return place != json.end() ? *place : kNothing;
}

std::string name_of(const fs::path& directory) {
  const fs::path whole = fs::weakly_canonical(directory);
  return whole.has_filename() ? whole.filename().string() : whole.string();
}

const Curves* RunReport::find(std::string_view file) const {
  return find_by(curves, &Curves::name, file);
}

std::string title_of(const Config& config) {
  const std::string bodies = config.species.size() > 1 ? fmt::format("bodies of {} species", config.species.size())
                                                       : sized_title(config.species[0]);
  return fmt::format("{} hard {}, packing fraction {:.4g}", config.number, bodies, config.packing_fraction);
}

RunReport read_run_report(const fs::path& directory, WithView with_view) {
  check_run_directory(directory, "a run or of a sweep");
  RunReport run;
  run.path = directory;
  run.name = name_of(directory);
  const fs::path config_file = directory / kConfigFile;
  run.config_text = read_file(config_file, kLongestText);
  run.config = parse_config(run.config_text, config_file.string());
  run.title = title_of(run.config);
  for (const SpeciesConfig& species : run.config.species) {
    run.rotational_freedoms += static_cast<long>(species.rotation_axes()) * species.number;
  }
  run.log = read_log(directory / kLogFile);
  run.summary = read_summary(directory / kSummaryFile);
  run.curves = read_curves(directory);
  run.oriented = !std::all_of(run.config.species.begin(), run.config.species.end(), is_sphere);
  run.headlines = headlines_of(member(run.summary, "observables"), run.oriented);
  run.species = species_of(run.config, run.summary);
  std::optional<Seen> seen;
  std::vector<Remark> unseen;
  if (with_view == WithView::yes) {
    seen = if_readable([&] { return read_trajectory(directory / kGsdFile); }, "frames", unseen);
    if (!seen) {
      seen =
          if_readable([&] { return read_last_state(directory / kCheckpointFile, run.config); }, "last state", unseen);
    }
  }
  run.remarks = run.summary.is_null() ? std::vector{unfinished(seen)} : remarks_of(run.summary);
  run.remarks.insert(run.remarks.end(), unseen.begin(), unseen.end());
  if (seen && seen->cut_off) {
    run.remarks.push_back(
        {Remark::Kind::warning, "frames cut off", fmt::format("{} ends within a frame, which is left out.", kGsdFile)});
  }
  if (seen) run.view = std::move(seen->view);
  return run;
}

}  // namespace hardbody
