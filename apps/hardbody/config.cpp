#include "config.h"

#include "errors.h"
#include "suggest.h"
#include "text_file.h"
#include "toml_document.h"

#include <ed/start.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace hardbody {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLongestConfig = 1 << 20;  ///< bytes
constexpr std::int64_t kMostBodies = 1'000'000;
constexpr std::int64_t kMostEvents = 100'000'000;  ///< they are kept in memory: 16 bytes each
constexpr double kThinnest = 1e-2;                 ///< least aspect ratio; the largest is the inverse
constexpr double kLongestTime = 1e9;

constexpr double kLeastPacking = 1e-9;

constexpr std::array<std::string_view, 6> kSections = {"system",        "shape",      "dynamics",
                                                       "equilibration", "production", "output"};
constexpr std::array<std::string_view, 18> kKeys = {
    "seed",
    "system.number",
    "system.packing_fraction",
    "shape.kind",
    "shape.aspect_ratio",
    "shape.semi_axes",
    "shape.exponents",
    "dynamics.inertia",
    "dynamics.finder",
    "dynamics.eps_d",
    "dynamics.distance",
    "dynamics.neighbours",
    "equilibration.time",
    "production.time",
    "output.events",
    "output.trajectory",
    "output.frames",
    "output.checkpoint_every",
};

// ---- Messages

InputError bad(const Entry& entry, std::string_view accepted) {
  return InputError(fmt::format("{}: {} is {}; accepted: {}", entry.where, entry.key, entry.value.shown, accepted));
}

InputError not_yet(const Entry& entry, std::string_view accepted) {
  return InputError(fmt::format("{}: {} = {} is not available yet; accepted now: {}", entry.where, entry.key,
                                entry.value.shown, accepted));
}

// ---- Names

bool known_section(std::string_view name) {
  return std::find(kSections.begin(), kSections.end(), name) != kSections.end();
}

void check_sections(const TomlDocument& document) {
  for (const Section& section : document.sections) {
    if (known_section(section.name)) continue;
    if (section.name == "species") {
      throw InputError(fmt::format("{}: species is not available yet; accepted now: one [shape]", section.where));
    }
    const auto nearest = nearest_name(section.name, kSections);
    throw InputError(fmt::format(
        "{}: unknown section [{}]{}; accepted: [system], [shape], [dynamics], "
        "[equilibration], [production], [output]",
        section.where, one_line(section.name, 40), nearest ? fmt::format(", did you mean [{}]?", *nearest) : ""));
  }
}

/// "system.number, system.packing_fraction": the keys of the unknown key's section, or all.
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

void check_names(const TomlDocument& document) {
  check_sections(document);
  for (const Entry& entry : document.entries) {
    if (std::find(kKeys.begin(), kKeys.end(), entry.key) != kKeys.end()) continue;
    if (known_section(entry.key)) throw bad(entry, fmt::format("a section [{}] with keys", entry.key));
    if (entry.key == "species" || entry.key.starts_with("species.")) {
      throw InputError(fmt::format("{}: {} is not available yet; accepted now: one [shape]", entry.where, entry.key));
    }
    const auto nearest = nearest_name(entry.key, kKeys);
    const std::string name = one_line(entry.key, 60);
    throw InputError(nearest ? fmt::format("{}: unknown key {}, did you mean {}?; accepted: {}", entry.where, name,
                                           *nearest, keys_near(*nearest))
                             : fmt::format("{}: unknown key {}; accepted: {}", entry.where, name, keys_near("")));
  }
}

// ---- Values

bool is_number(const Value& value) {
  return (value.kind == Value::Kind::integer || value.kind == Value::Kind::real) && std::isfinite(value.real);
}

void read_integer(const TomlDocument& document, std::string_view key, std::int64_t least, std::int64_t most,
                  std::int64_t& result) {
  const Entry* entry = document.find(key);
  if (entry == nullptr) return;
  if (entry->value.kind != Value::Kind::integer || entry->value.integer < least || entry->value.integer > most) {
    throw bad(*entry, most == std::numeric_limits<std::int64_t>::max()
                          ? fmt::format("an integer, at least {}", least)
                          : fmt::format("an integer from {} to {}", least, most));
  }
  result = entry->value.integer;
}

/// A time: a number in [least, kLongestTime], 0 excluded if least is, or "auto".
void read_time(const TomlDocument& document, std::string_view key, bool zero, std::optional<double>& result) {
  const Entry* entry = document.find(key);
  if (entry == nullptr) return;
  const Value& value = entry->value;
  if (value.kind == Value::Kind::text && value.text == "auto") {
    result = std::nullopt;
    return;
  }
  if (!is_number(value) || value.real < 0 || (value.real == 0 && !zero) || value.real > kLongestTime) {
    throw bad(*entry, fmt::format("\"auto\" or a number {}, at most {:g} (time unit l sqrt(m/kT))",
                                  zero ? "at least 0" : "above 0", kLongestTime));
  }
  result = value.real;
}

struct Choice {
  std::string_view name;
  bool available;
};

std::string list_of(std::initializer_list<Choice> choices) {
  std::string list;
  for (const Choice& choice : choices) {
    if (!choice.available) continue;
    if (!list.empty()) list += ", ";
    list += fmt::format("\"{}\"", choice.name);
  }
  return list;
}

void read_choice(const TomlDocument& document, std::string_view key, std::initializer_list<Choice> choices,
                 std::string& result) {
  const Entry* entry = document.find(key);
  if (entry == nullptr) return;
  for (const Choice& choice : choices) {
    if (entry->value.kind != Value::Kind::text || entry->value.text != choice.name) continue;
    if (!choice.available) throw not_yet(*entry, list_of(choices));
    result = choice.name;
    return;
  }
  throw bad(*entry, list_of(choices));
}

/// Three finite positive numbers.
Vector3d read_three(const Entry& entry, std::string_view accepted) {
  const Value& value = entry.value;
  if (value.kind != Value::Kind::array || value.items.size() != 3) throw bad(entry, accepted);
  Vector3d result;
  for (int k = 0; k < 3; ++k) {
    const Value& item = value.items[static_cast<std::size_t>(k)];
    if (!is_number(item) || !(item.real > 0)) throw bad(entry, accepted);
    result[k] = item.real;
  }
  return result;
}

// ---- Shape and inertia

constexpr std::string_view kAxesAccepted = "three positive finite numbers of which two are equal";

/// Where the axis of revolution stands in [a, b, c]; 2 for a sphere.
int axis_of_revolution(const Vector3d& axes) {
  if (axes.x() == axes.y()) return 2;
  if (axes.y() == axes.z()) return 0;
  return axes.x() == axes.z() ? 1 : -1;
}

/// The values about body x, y, z after the permutation that makes `axis` the z axis; the other two are equal.
Vector3d axis_last(const Vector3d& v, int axis) {
  return {v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]};
}

Vector3d semi_axes_from_aspect_ratio(const Entry& entry, double& aspect_ratio) {
  if (!is_number(entry.value) || !(entry.value.real >= kThinnest && entry.value.real <= 1 / kThinnest)) {
    throw bad(entry, fmt::format("a number from {:g} to {:g} (X0 = a/b, a along the axis of revolution)", kThinnest,
                                 1 / kThinnest));
  }
  aspect_ratio = entry.value.real;
  const double b = 1 / std::cbrt(aspect_ratio);
  return {b, b, aspect_ratio * b};
}

Vector3d semi_axes_from_list(const Entry& entry, Vector3d& given) {
  given = read_three(entry, kAxesAccepted);
  const int axis = axis_of_revolution(given);
  if (axis < 0) {
    throw InputError(fmt::format("{}: {} is {}: three different semi-axes are not available yet; accepted now: {}",
                                 entry.where, entry.key, entry.value.shown, kAxesAccepted));
  }
  const double ratio = given[axis] / given[(axis + 1) % 3];
  if (!(ratio >= kThinnest && ratio <= 1 / kThinnest)) {
    throw bad(entry, fmt::format("semi-axes whose ratio is from {:g} to {:g}", kThinnest, 1 / kThinnest));
  }
  const double b = 1 / std::cbrt(ratio);
  return {b, b, ratio * b};
}

geom::Ellipsoid read_shape(const TomlDocument& document, Config& config) {
  const Entry* kind = document.find("shape.kind");
  const Entry* exponents = document.find("shape.exponents");
  if (kind != nullptr && kind->value.text == "superellipsoid") throw not_yet(*kind, "\"ellipsoid\"");
  if (kind != nullptr && kind->value.text != "ellipsoid") throw bad(*kind, "\"ellipsoid\"");
  if (exponents != nullptr) throw not_yet(*exponents, "kind = \"ellipsoid\", which has no exponents");
  const Entry* ratio = document.find("shape.aspect_ratio");
  const Entry* axes = document.find("shape.semi_axes");
  if (ratio != nullptr && axes != nullptr) {
    const Entry& later = ratio->line != 0 && (axes->line == 0 || axes->line > ratio->line) ? *axes : *ratio;
    throw InputError(fmt::format("{}: shape.aspect_ratio is {} and shape.semi_axes is {}; accepted: only one of them",
                                 later.where, ratio->value.shown, axes->value.shown));
  }
  if (ratio != nullptr) {
    return geom::Ellipsoid(semi_axes_from_aspect_ratio(*ratio, config.aspect_ratio.emplace()));
  }
  if (axes != nullptr) return geom::Ellipsoid(semi_axes_from_list(*axes, config.semi_axes.emplace()));
  throw InputError(
      fmt::format("{}: the section [shape] needs shape.aspect_ratio or shape.semi_axes and has none; "
                  "accepted: one of them",
                  document.where_of("shape")));
}

Vector3d check_moments(const Entry& entry, const Config& config) {
  constexpr std::string_view kAccepted =
      "\"paper\", \"uniform\" or three positive moments [I1, I2, I3] of which none exceeds the sum of the "
      "other two";
  Vector3d given = read_three(entry, kAccepted);
  if (!(given.maxCoeff() <= (given.sum() - given.maxCoeff()) * (1 + 1e-12))) throw bad(entry, kAccepted);
  const Vector3d moments = axis_last(given, config.semi_axes ? axis_of_revolution(*config.semi_axes) : 2);
  if (moments.x() != moments.y()) {
    throw InputError(
        fmt::format("{}: {} is {}: two different moments across the axis of revolution are not available "
                    "yet; accepted now: equal ones",
                    entry.where, entry.key, entry.value.shown));
  }
  return given;
}

ed::Species read_inertia(const TomlDocument& document, const geom::Ellipsoid& shape, Config& config) {
  const Entry* entry = document.find("dynamics.inertia");
  if (entry != nullptr && entry->value.kind == Value::Kind::text) {
    if (entry->value.text != "paper" && entry->value.text != "uniform") {
      throw bad(*entry, "\"paper\", \"uniform\" or three moments [I1, I2, I3]");
    }
    config.inertia = entry->value.text;
  } else if (entry != nullptr) {
    config.inertia_moments = check_moments(*entry, config);
    config.inertia = "moments";
  }
  if (config.inertia == "paper") return ed::paper_species(shape);
  ed::Species species = ed::uniform_species(shape);
  if (config.inertia == "moments") {
    species.inertia = axis_last(config.inertia_moments, config.semi_axes ? axis_of_revolution(*config.semi_axes) : 2);
  }
  return species;
}

// ---- Sections

void read_packing(const TomlDocument& document, Config& config) {
  const geom::Ellipsoid& shape = config.species.shape;
  const double densest = ed::densest_start(shape);
  // Rounded down: the value that the message names is accepted.
  const std::string accepted =
      fmt::format("a number from {:g} to {:.4f} for this shape", kLeastPacking, std::floor(densest * 1e4) / 1e4);
  const Entry* packing = document.find("system.packing_fraction");
  if (packing == nullptr) {
    throw InputError(
        fmt::format("{}: system.packing_fraction is missing; accepted: {}", document.where_of("system"), accepted));
  }
  const double phi = packing->value.real;
  if (!is_number(packing->value) || !(phi >= kLeastPacking && phi <= densest)) throw bad(*packing, accepted);
  config.packing_fraction = phi;
}

void read_number(const TomlDocument& document, Config& config) {
  std::int64_t number = config.number;
  read_integer(document, "system.number", 2, kMostBodies, number);
  config.number = static_cast<int>(number);
  const geom::Ellipsoid& shape = config.species.shape;
  const bool cells = config.neighbours == "cells";
  const int least =
      ed::smallest_number(shape, config.packing_fraction, cells ? ed::Neighbours::cells : ed::Neighbours::dilated);
  if (config.number >= least) return;
  const Entry* entry = document.find("system.number");
  if (entry == nullptr) entry = document.find("system.packing_fraction");
  throw InputError(fmt::format(
      "{}: system.number is {}: the box, {:.4g} long at this packing fraction, is then too small for bodies of "
      "bounding radius {:.4g} ({}); accepted: a number of at least {}",
      entry->where, config.number, ed::box_for(shape, config.number, config.packing_fraction), shape.bounding_radius(),
      cells ? "three cells as wide as two of them must fit along an edge" : "a body would meet two images of another",
      least));
}

/// What neighbours = "auto" takes.
void choose_neighbours(Config& config) {
  const auto finder = config.finder == "certified" ? ed::Finder::certified : ed::Finder::bracketing;
  const bool cells = ed::fastest_neighbours(config.species.shape, config.number, config.packing_fraction, finder) ==
                     ed::Neighbours::cells;
  config.neighbours = cells ? "cells" : "dilated";
}

void read_dynamics(const TomlDocument& document, const geom::Ellipsoid& shape, Config& config) {
  config.species = read_inertia(document, shape, config);
  read_choice(document, "dynamics.finder", {{"certified", true}, {"bracketing", true}}, config.finder);
  read_choice(document, "dynamics.distance", {{"dual", true}, {"newton8", true}, {"newton5", true}}, config.distance);
  if (config.finder == "certified" && config.distance != "dual") {
    throw bad(*document.find("dynamics.distance"), "\"dual\" with finder = \"certified\"; others with \"bracketing\"");
  }
  config.neighbours = "auto";
  read_choice(document, "dynamics.neighbours", {{"auto", true}, {"dilated", true}, {"obp", true}, {"cells", true}},
              config.neighbours);
  config.neighbours_chosen = config.neighbours == "auto";
  const Entry* eps_d = document.find("dynamics.eps_d");
  if (eps_d == nullptr) return;
  const double limit = shape.inscribed_radius();
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

void read_output(const TomlDocument& document, Config& config) {
  read_integer(document, "output.events", 0, kMostEvents, config.events);
  if (const Entry* trajectory = document.find("output.trajectory")) {
    constexpr std::string_view kAccepted = "[], no trajectory";
    if (trajectory->value.kind != Value::Kind::array) throw bad(*trajectory, kAccepted);
    for (const Value& item : trajectory->value.items) {
      const bool planned = item.text == "gsd" || item.text == "lammps" || item.text == "vtk";
      throw planned ? not_yet(*trajectory, kAccepted) : bad(*trajectory, kAccepted);
    }
  }
  if (const Entry* frames = document.find("output.frames")) throw not_yet(*frames, "no key frames");
  if (const Entry* every = document.find("output.checkpoint_every")) {
    if (every->value.kind != Value::Kind::text || !parse_duration(every->value.text)) {
      throw bad(*every, "a string of a positive number and a unit, as in \"60s\", \"5m\", \"1h\"");
    }
    config.checkpoint_every = every->value.text;
  }
}

}  // namespace

double Config::true_aspect_ratio() const {
  if (aspect_ratio) return *aspect_ratio;
  // From the axes as given: the rescaled ones would turn 3 into 2.9999999999999996.
  const int axis = axis_of_revolution(*semi_axes);
  return (*semi_axes)[axis] / (*semi_axes)[(axis + 1) % 3];
}

ed::SimulationOptions Config::simulation_options(double envelope) const {
  ed::SimulationOptions options;
  options.envelope = envelope;
  if (neighbours == "obp") options.neighbours = ed::Neighbours::obp;
  if (neighbours == "cells") options.neighbours = ed::Neighbours::cells;
  if (finder == "bracketing") options.contact.finder = ed::Finder::bracketing;
  if (distance == "newton8") options.contact.distance = ed::DistanceMethod::newton8;
  if (distance == "newton5") options.contact.distance = ed::DistanceMethod::newton5;
  options.contact.eps_d = eps_d;
  return options;
}

double Config::checkpoint_seconds() const {
  return parse_duration(checkpoint_every).value_or(std::numeric_limits<double>::infinity());
}

Config parse_config(std::string_view text, const std::string& name, const std::vector<std::string>& overrides) {
  const TomlDocument document = read_toml(text, name, overrides);
  check_names(document);
  Config config;
  read_integer(document, "seed", 0, std::numeric_limits<std::int64_t>::max(), config.seed);
  read_time(document, "equilibration.time", true, config.equilibration_time);
  read_time(document, "production.time", false, config.production_time);
  read_output(document, config);
  read_dynamics(document, read_shape(document, config), config);
  read_packing(document, config);
  read_number(document, config);
  if (config.neighbours_chosen) choose_neighbours(config);
  return config;
}

Config load_config(const std::string& path, const std::vector<std::string>& overrides) {
  return parse_config(read_file(path, kLongestConfig), path, overrides);
}

}  // namespace hardbody
