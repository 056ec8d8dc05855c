#include "config/config.h"

#include "base/errors.h"
#include "base/suggest.h"
#include "config/box.h"
#include "config/species.h"
#include "config/start_additions.h"
#include "config/values.h"
#include "io/text_file.h"
#include "io/toml_document.h"

#include <ed/observables.h>
#include <ed/polydispersity.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>

namespace hardbody {
namespace {

constexpr std::size_t kLongestConfig = 1 << 20;    ///< bytes
constexpr std::int64_t kMostEvents = 100'000'000;  ///< of events.csv, 50 bytes each
constexpr std::int64_t kMostFrames = 100'000;      ///< there is room for all of them in the files' heads
constexpr double kLongestTime = 1e9;               ///< this and the next two: in ed::time_unit of the bodies
constexpr double kUsualCap = 500;
constexpr double kLeastCap = 1;
constexpr double kUsualEpsD = 1e-6;  ///< of the bodies' length
constexpr double kLargestWaveNumber = 1e6;
constexpr double kLeastPacking = 1e-9;

constexpr std::array<std::string_view, 8> kSections = {"system",   "start",         "shape",      "species",
                                                       "dynamics", "equilibration", "production", "output"};
constexpr std::array<std::string_view, 39> kKeys = {
    "seed",
    "system.number",
    "system.packing_fraction",
    "system.start",
    "system.nematic_order",
    "system.start_from",
    "start.file",
    "start.frame",
    "start.mend",
    "start.reverse",
    "shape.kind",
    "shape.aspect_ratio",
    "shape.semi_axes",
    "shape.exponents",
    "species.kind",
    "species.aspect_ratio",
    "species.semi_axes",
    "species.exponents",
    "species.fraction",
    "species.number",
    "species.mass",
    "species.inertia",
    "species.sizes",
    "species.width",
    "species.size_seed",
    "dynamics.inertia",
    "dynamics.finder",
    "dynamics.eps_d",
    "dynamics.distance",
    "dynamics.neighbours",
    "equilibration.time",
    "equilibration.cap",
    "production.time",
    "production.target_error",
    "production.wave_numbers",
    "output.events",
    "output.trajectory",
    "output.frames",
    "output.checkpoint_every",
};

// ---- Names

bool known_section(std::string_view name) {
  return std::find(kSections.begin(), kSections.end(), name) != kSections.end();
}

/// "[2]" of species[2] and species[2].mass; empty where there is none.
std::string_view index_in(std::string_view name) {
  const std::size_t open = name.find('[');
  const std::size_t close = name.find(']');
  if (open == std::string_view::npos || close == std::string_view::npos || close < open) return {};
  return name.substr(open, close - open + 1);
}

std::string without_index(std::string_view name) {
  const std::string_view index = index_in(name);
  std::string result(name);
  return index.empty() ? result : result.erase(result.find(index), index.size());
}

/// species.mass as species[2].mass.
std::string with_index(std::string_view key, std::string_view index) {
  std::string result(key);
  return key.starts_with("species.") ? result.insert(result.find('.'), index) : result;
}

void check_sections(const TomlDocument& document) {
  for (const Section& section : document.sections) {
    const bool several = section.several;
    const std::string name = several ? without_index(section.name) : section.name;
    if (known_section(name) && several == (name == "species")) continue;
    if (known_section(name)) {
      throw InputError(fmt::format(
          "{}: [{}] is {}; accepted: {}", section.where, name, several ? "there as an array, [[..]]" : "one section",
          several ? fmt::format("[{}], once", name) : std::string("[[species]], one for each kind of bodies")));
    }
    const auto nearest = nearest_name(name, kSections);
    throw InputError(
        fmt::format("{}: unknown section [{}]{}; accepted: [system], [start], [shape] or [[species]], [dynamics], "
                    "[equilibration], [production], [output]",
                    section.where, one_line(name, 40), nearest ? fmt::format(", did you mean [{}]?", *nearest) : ""));
  }
}

/// "system.number, system.packing_fraction": the keys of the key's section; all keys for a key without a section.
std::string keys_near(std::string_view key) {
  const std::string section(key.substr(0, key.find('.') == std::string_view::npos ? 0 : key.find('.') + 1));
  std::string list;
  for (const std::string_view known : kKeys) {
    if (!known.starts_with(section)) continue;
    if (!list.empty()) list += ", ";
    list += known;
  }
  return list;
}

/// A key of a [[species]] that the file does not have, from the command line.
void check_index(const TomlDocument& document, const Entry& entry) {
  const std::string section = entry.key.substr(0, entry.key.find('.'));
  if (!section.starts_with("species")) return;
  int number = 0;
  for (const Section& s : document.sections) {
    if (s.name == section) return;
    if (s.several) ++number;
  }
  throw InputError(number == 0 ? fmt::format("{}: {} needs sections [[species]] in the file, which has none; accepted: "
                                             "[[species]], or keys of [shape]",
                                             entry.where, entry.key)
                               : fmt::format("{}: there is no {} in the file; accepted: species[1] to species[{}]",
                                             entry.where, section, number));
}

void check_names(const TomlDocument& document) {
  check_sections(document);
  for (const Entry& entry : document.entries) {
    const std::string key = without_index(entry.key);
    const std::string_view index = index_in(entry.key);
    const bool indexed = index.empty() || entry.key == with_index(key, index);
    if (indexed && std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end()) {
      check_index(document, entry);
      continue;
    }
    if (entry.key == "species") throw bad(entry, "sections [[species]], one for each kind of bodies");
    if (known_section(entry.key)) throw bad(entry, fmt::format("a section [{}] with keys", entry.key));
    const auto nearest = nearest_name(key, kKeys);
    const std::string name = one_line(entry.key, 60);
    const bool in_section = known_section(key.substr(0, key.find('.')));
    throw InputError(fmt::format("{}: unknown key {}{}; accepted: {}", entry.where, name,
                                 nearest ? fmt::format(", did you mean {}?", with_index(*nearest, index)) : "",
                                 keys_near(in_section ? key : nearest.value_or(""))));
  }
}

// ---- Values

/// A time: a number up to `longest`, 0 only with `zero`, or "auto".
void read_time(const TomlDocument& document, std::string_view key, bool zero, double longest,
               std::optional<double>& result) {
  const Entry* entry = document.find(key);
  if (entry == nullptr) return;
  const Value& value = entry->value;
  if (value.kind == Value::Kind::text && value.text == "auto") {
    result = std::nullopt;
    return;
  }
  if (!is_number(value) || value.real < 0 || (value.real == 0 && !zero) || value.real > longest) {
    throw bad(*entry, fmt::format("\"auto\" or a number {}, at most {:g} (time unit l sqrt(m/kT))",
                                  zero ? "at least 0" : "above 0", longest));
  }
  result = value.real;
}

// ---- Sections

void read_times(const TomlDocument& document, Config& config) {
  config.time_unit = ed::time_unit(config.components());
  const double least = kLeastCap * config.time_unit;
  const double longest = kLongestTime * config.time_unit;
  read_time(document, "equilibration.time", true, longest, config.equilibration_time);
  read_time(document, "production.time", true, longest, config.production_time);
  config.equilibration_cap = kUsualCap * config.time_unit;
  if (const Entry* cap = document.find("equilibration.cap")) {
    if (!is_number(cap->value) || !(cap->value.real >= least && cap->value.real <= longest)) {
      throw bad(*cap, fmt::format("a number from {:g} to {:g} (time unit l sqrt(m/kT))", least, longest));
    }
    config.equilibration_cap = cap->value.real;
  }
  const Entry* error = document.find("production.target_error");
  if (error == nullptr) return;
  if (config.production_time) throw bad(*error, "no target_error, or production.time = \"auto\"");
  if (!is_number(error->value) || !(error->value.real >= 1e-4 && error->value.real <= 1)) {
    throw bad(*error, "a number from 0.0001 to 1 (standard error over value, of D_trans and D_rot)");
  }
  config.target_error = error->value.real;
}

void read_wave_numbers(const TomlDocument& document, Config& config) {
  const Entry* entry = document.find("production.wave_numbers");
  if (entry == nullptr) return;
  const auto usable = [](const Value& v) { return is_number(v) && v.real > 0 && v.real <= kLargestWaveNumber; };
  const std::vector<Value>& items = entry->value.items;
  if (entry->value.kind != Value::Kind::array || items.size() > ed::kMostWaveNumbers ||
      !std::all_of(items.begin(), items.end(), usable)) {
    throw bad(*entry, fmt::format("a list of at most {} numbers above 0, at most {:g} (1/l)", ed::kMostWaveNumbers,
                                  kLargestWaveNumber));
  }
  for (const Value& item : items) config.wave_numbers.push_back(item.real);
}

/// A run to go on from, instead of a start of one's own.
void read_origin(const TomlDocument& document, Config& config) {
  const Entry* from = document.find("system.start_from");
  if (from == nullptr) return;
  if (from->value.kind != Value::Kind::text || from->value.text.empty()) throw bad(*from, "the directory of a run");
  for (const char* key : {"system.start", "system.nematic_order", "start.file"}) {
    const Entry* other = document.find(key);
    const bool is_default = other != nullptr && other->key == "system.start" && other->value.text == "random";
    if (other != nullptr && !is_default) throw bad(*other, fmt::format("no key {} beside start_from", key));
  }
  config.start_from = from->value.text;
}

void read_start(const TomlDocument& document, Config& config) {
  read_origin(document, config);
  read_choice(document, "system.start", {"random", "cubic", "fcc"}, config.start);
  const Entry* order = document.find("system.nematic_order");
  if (order == nullptr) return;
  if (!is_number(order->value) || !(order->value.real >= 0 && order->value.real < 1)) {
    throw bad(*order, "a number at least 0, below 1 (the order parameter S of the start)");
  }
  if (std::all_of(config.species.begin(), config.species.end(), is_sphere))
    throw bad(*order, "no key nematic_order: spheres have no orientation");
  config.nematic_order = order->value.real;
}

/// Above, on a lattice. How dense it can be depends on the number of bodies too: check_lattice.
constexpr double kDensestLattice = 0.9999;

void read_packing(const TomlDocument& document, Config& config) {
  const bool ordered = config.lattice() || config.start_file;
  const double densest = ordered ? kDensestLattice : ed::densest_start(config.components());
  // Rounded down: the value that the message names is accepted.
  const std::string accepted =
      fmt::format("a number from {:g} to {:.4f} for {}", kLeastPacking, std::floor(densest * 1e4) / 1e4,
                  config.start_file  ? "a start from a file"
                  : config.lattice() ? "a lattice"
                  : config.mixture   ? "these shapes"
                                     : "this shape");
  const Entry* packing = document.find("system.packing_fraction");
  if (packing == nullptr) {
    throw InputError(
        fmt::format("{}: system.packing_fraction is missing; accepted: {}", document.where_of("system"), accepted));
  }
  const double phi = packing->value.real;
  if (!is_number(packing->value) || !(phi >= kLeastPacking && phi <= densest)) throw bad(*packing, accepted);
  config.packing_fraction = phi;
}

/// What neighbours = "auto" takes. Only ellipsoids of revolution have been measured; for others, and for bodies of
/// several sizes, dilated bodies are what costs little at any density.
void choose_neighbours(Config& config) {
  config.neighbours = "dilated";
  if (config.mixture || !std::holds_alternative<geom::Ellipsoid>(config.species[0].body.shape)) return;
  if (!config.all_of_revolution()) return;
  const auto finder = config.finder == "certified" ? ed::Finder::certified : ed::Finder::bracketing;
  if (ed::fastest_neighbours(config.species[0].body.shape, config.number, config.packing_fraction, finder) ==
      ed::Neighbours::cells) {
    config.neighbours = "cells";
  }
}

void read_finder(const TomlDocument& document, Config& config) {
  read_choice(document, "dynamics.finder", {"certified", "bracketing"}, config.finder);
  read_choice(document, "dynamics.distance", {"dual", "newton8", "newton5"}, config.distance);
  if (config.finder == "certified" && config.distance != "dual") {
    throw bad(*document.find("dynamics.distance"), "\"dual\" with finder = \"certified\"; others with \"bracketing\"");
  }
}

/// Radius of the sphere of the bodies' volume: the mean, as a power of two.
double mean_length(std::vector<ed::Component> components) {
  for (ed::Component& component : components) component.species.mass = 1;
  return ed::time_unit(components);
}

void read_dynamics(const TomlDocument& document, Config& config) {
  read_finder(document, config);
  config.neighbours = "auto";
  read_choice(document, "dynamics.neighbours", {"auto", "dilated", "obp", "cells"}, config.neighbours);
  config.neighbours_chosen = config.neighbours == "auto";
  config.eps_d = kUsualEpsD * mean_length(config.components());
  const Entry* eps_d = document.find("dynamics.eps_d");
  if (eps_d == nullptr) return;
  double limit = std::numeric_limits<double>::infinity();
  for (const ed::Component& c : config.components()) limit = std::min(limit, ed::inscribed_radius(c.species.shape));
  if (!is_number(eps_d->value) || !(eps_d->value.real > 0 && eps_d->value.real < limit)) {
    throw bad(*eps_d, fmt::format("a number above 0 and below the smallest semi-axis, {:.4g}", limit));
  }
  config.eps_d = eps_d->value.real;
}

/// Seconds of a number and a unit, 60s, 5m, 1.5h; nothing for anything else.
std::optional<double> parse_duration(const std::string& text) {
  if (text.size() < 2 || text.size() > 16) return std::nullopt;
  const std::string number = text.substr(0, text.size() - 1);
  const auto digit = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
  if (!std::all_of(number.begin(), number.end(), digit) || std::count(number.begin(), number.end(), '.') > 1) {
    return std::nullopt;
  }
  if (std::none_of(number.begin(), number.end(), [](char c) { return c >= '1' && c <= '9'; })) return std::nullopt;
  switch (text.back()) {
    case 's':
      return std::stod(number);
    case 'm':
      return 60 * std::stod(number);
    case 'h':
      return 3600 * std::stod(number);
    default:
      return std::nullopt;
  }
}

void read_trajectory(const TomlDocument& document, Config& config) {
  read_integer(document, "output.frames", 2, kMostFrames, config.frames);
  const Entry* trajectory = document.find("output.trajectory");
  if (trajectory == nullptr) return;
  constexpr std::string_view kAccepted = "an array of \"gsd\", \"lammps\" and \"vtk\", each at most once";
  if (trajectory->value.kind != Value::Kind::array) throw bad(*trajectory, kAccepted);
  for (const Value& item : trajectory->value.items) {
    const bool known =
        item.kind == Value::Kind::text && (item.text == "gsd" || item.text == "lammps" || item.text == "vtk");
    const bool twice =
        std::find(config.trajectory.begin(), config.trajectory.end(), item.text) != config.trajectory.end();
    if (!known || twice) throw bad(*trajectory, kAccepted);
    config.trajectory.push_back(item.text);
  }
}

void read_output(const TomlDocument& document, Config& config) {
  read_integer(document, "output.events", 0, kMostEvents, config.events);
  read_trajectory(document, config);
  if (const Entry* every = document.find("output.checkpoint_every")) {
    if (every->value.kind != Value::Kind::text || !parse_duration(every->value.text)) {
      throw bad(*every, "a string of a positive number and a unit, as in \"60s\", \"5m\", \"1h\"");
    }
    config.checkpoint_every = every->value.text;
  }
}

/// The document with what it leaves to the file that it starts from.
TomlDocument completed(const TomlDocument& document, const StartFile& start, const StartAdditions& more) {
  TomlDocument whole = document;
  TomlDocument added = read_toml(more.text, start.file, more.overrides);
  for (Section& section : added.sections) {
    section.where = start.file;
    whole.sections.push_back(std::move(section));
  }
  for (Entry& entry : added.entries) {
    entry.where = start.file;
    whole.set(std::move(entry));
  }
  return whole;
}

}  // namespace

std::vector<ed::Component> Config::components() const {
  std::vector<ed::Component> list;
  for (const SpeciesConfig& s : species) {
    if (s.factors.empty()) list.push_back({s.body, s.number});
    for (const double factor : s.factors) list.push_back({ed::scaled(s.body, factor), 1});
  }
  return list;
}

std::vector<ed::BodyGroup> Config::groups() const {
  std::vector<ed::BodyGroup> list;
  for (const SpeciesConfig& s : species) list.push_back({s.number, s.rotation_axes()});
  return list;
}

std::vector<int> Config::numbers() const {
  std::vector<int> list;
  for (const SpeciesConfig& s : species) list.push_back(s.number);
  return list;
}

bool Config::all_of_revolution() const {
  return std::all_of(species.begin(), species.end(), [](const SpeciesConfig& s) { return s.rotation_axes() == 2; });
}

ed::Neighbours Config::neighbour_search() const {
  if (neighbours == "obp") return ed::Neighbours::obp;
  if (neighbours == "cells") return ed::Neighbours::cells;
  return ed::Neighbours::dilated;
}

bool is_sphere(const SpeciesConfig& species) {
  return ed::is_sphere(species.body.shape);
}

ed::SimulationOptions Config::simulation_options(double envelope) const {
  ed::SimulationOptions options;
  options.envelope = envelope;
  options.neighbours = neighbour_search();
  if (finder == "bracketing") options.contact.finder = ed::Finder::bracketing;
  if (distance == "newton8") options.contact.distance = ed::DistanceMethod::newton8;
  if (distance == "newton5") options.contact.distance = ed::DistanceMethod::newton5;
  options.contact.eps_d = eps_d;
  return options;
}

std::optional<ed::LatticeOptions> Config::lattice() const {
  if (start == "random") return std::nullopt;
  ed::LatticeOptions options;
  options.lattice = start == "fcc" ? ed::Lattice::fcc : ed::Lattice::simple_cubic;
  options.packing_fraction = packing_fraction;
  options.seed = static_cast<std::uint64_t>(seed);
  options.nematic_order = nematic_order;
  options.groups = numbers();
  return options;
}

double Config::checkpoint_seconds() const {
  return parse_duration(checkpoint_every).value_or(std::numeric_limits<double>::infinity());
}

Config read_config(const TomlDocument& document) {
  check_names(document);
  Config config;
  config.start_file = read_start_file(document);
  if (config.start_file) {
    const StartAdditions more = additions_from(*config.start_file, document);
    if (!more.empty()) return read_config(completed(document, *config.start_file, more));
  }
  read_integer(document, "seed", 0, std::numeric_limits<std::int64_t>::max(), config.seed);
  read_species(document, config);
  read_times(document, config);
  read_wave_numbers(document, config);
  read_output(document, config);
  read_dynamics(document, config);
  read_start(document, config);
  read_packing(document, config);
  check_box(document, config);
  check_lattice(document, config);
  if (config.neighbours_chosen) choose_neighbours(config);
  return config;
}

Config parse_config(std::string_view text, const std::string& name, const std::vector<std::string>& overrides) {
  return read_config(read_toml(text, name, overrides));
}

Config load_config(const std::string& path, const std::vector<std::string>& overrides) {
  return parse_config(read_file(path, kLongestConfig), path, overrides);
}

}  // namespace hardbody
