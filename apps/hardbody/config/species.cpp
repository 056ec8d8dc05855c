#include "config/species.h"

#include "config/values.h"

#include <ed/polydispersity.h>
#include <ed/random.h>
#include <ed/tolerances.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace hardbody {
namespace {

using Eigen::Vector3d;

constexpr double kThinnest = 1e-2;      ///< least ratio of two semi-axes; the largest is the inverse
constexpr double kShortestAxis = 1e-3;  ///< where semi-axes are taken literally; the longest is the inverse
constexpr double kLightest = 1e-6;      ///< the heaviest is the inverse
constexpr double kFractionRounding = 1e-6;

/// Where the keys of one kind of bodies stand.
struct Place {
  std::string section;  ///< shape, or species[2]
  std::string inertia;  ///< key
  bool literal;         ///< lengths are taken as they are given

  std::string key(std::string_view name) const { return fmt::format("{}.{}", section, name); }
};

// ---- Shape

/// Where the axis of revolution stands in [a, b, c] (of an ellipsoid); 2 for a sphere; -1: there is none.
int axis_of_revolution(const Vector3d& axes) {
  if (axes.x() == axes.y()) return 2;
  if (axes.y() == axes.z()) return 0;
  return axes.x() == axes.z() ? 1 : -1;
}

/// The same of the body that the user means.
int axis_of_revolution(const ShapeConfig& shape) {
  if (!shape.semi_axes) return 2;
  if (shape.kind == "superellipsoid") return shape.semi_axes->x() == shape.semi_axes->y() ? 2 : -1;
  return axis_of_revolution(*shape.semi_axes);
}

/// The values about body x, y, z after the permutation that makes `axis` the z axis.
Vector3d axis_last(const Vector3d& v, int axis) {
  return axis < 0 ? v : Vector3d(v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]);
}

void read_aspect_ratio(const Entry& entry, ShapeConfig& shape) {
  if (!is_number(entry.value) || !(entry.value.real >= kThinnest && entry.value.real <= 1 / kThinnest)) {
    throw bad(entry, fmt::format("a number from {:g} to {:g} (X0 = a/b, a along the axis of revolution)", kThinnest,
                                 1 / kThinnest));
  }
  shape.aspect_ratio = entry.value.real;
}

void read_semi_axes(const Entry& entry, const Place& place, ShapeConfig& shape) {
  shape.semi_axes = read_three(entry, "three positive finite numbers [a, b, c]");
  const double longest = shape.semi_axes->maxCoeff();
  const double shortest = shape.semi_axes->minCoeff();
  if (!(shortest >= kThinnest * longest)) {
    throw bad(entry, fmt::format("semi-axes of which none is more than {:g} times another", 1 / kThinnest));
  }
  if (place.literal && !(shortest >= kShortestAxis && longest <= 1 / kShortestAxis)) {
    throw bad(entry, fmt::format("semi-axes from {:g} to {:g}", kShortestAxis, 1 / kShortestAxis));
  }
}

void read_exponents(const TomlDocument& document, const Place& place, ShapeConfig& shape) {
  const std::string accepted =
      fmt::format("two numbers [e1, e2], each from {:g} to {:g}", ed::kMinExponentInMotion, ed::kMaxExponentInMotion);
  const Entry* entry = document.find(place.key("exponents"));
  if (shape.kind == "ellipsoid") {
    if (entry != nullptr) throw bad(*entry, "no exponents of an ellipsoid, or kind = \"superellipsoid\"");
    return;
  }
  if (entry == nullptr) {
    throw InputError(fmt::format("{}: {} of a superellipsoid is missing; accepted: {}",
                                 document.where_of(place.section), place.key("exponents"), accepted));
  }
  const std::vector<double> e = read_positive(*entry, 2, accepted);
  for (const double one : e) {
    if (!(one >= ed::kMinExponentInMotion && one <= ed::kMaxExponentInMotion)) throw bad(*entry, accepted);
  }
  shape.exponents = {e[0], e[1]};
}

void read_shape(const TomlDocument& document, const Place& place, ShapeConfig& shape) {
  read_choice(document, place.key("kind"), {"ellipsoid", "superellipsoid"}, shape.kind);
  read_exponents(document, place, shape);
  const Entry* ratio = document.find(place.key("aspect_ratio"));
  const Entry* axes = document.find(place.key("semi_axes"));
  if (ratio != nullptr && axes != nullptr) {
    const Entry& later = ratio->line != 0 && (axes->line == 0 || axes->line > ratio->line) ? *axes : *ratio;
    throw InputError(fmt::format("{}: {} is {} and {} is {}; accepted: only one of them", later.where, ratio->key,
                                 ratio->value.shown, axes->key, axes->value.shown));
  }
  if (ratio == nullptr && axes == nullptr) {
    throw InputError(fmt::format("{}: the section {} needs {} or {} and has none; accepted: one of them",
                                 document.where_of(place.section),
                                 place.literal ? fmt::format("{}", place.section) : "[shape]",
                                 place.key("aspect_ratio"), place.key("semi_axes")));
  }
  if (ratio != nullptr) read_aspect_ratio(*ratio, shape);
  if (axes != nullptr) read_semi_axes(*axes, place, shape);
}

/// Which axis of `semi_axes` becomes body z; -1: all stay as they are given.
int axis_moved_last(const ShapeConfig& shape) {
  return shape.kind == "ellipsoid" ? axis_of_revolution(shape) : -1;
}

/// The semi-axes in the program's units, an ellipsoid's axis of revolution last.
Vector3d semi_axes_in_use(const ShapeConfig& shape, bool literal) {
  const std::optional<double> ratio = shape.true_aspect_ratio();
  if (!shape.semi_axes || (ratio && !literal)) {
    const double b = 1 / std::cbrt(*ratio);
    return {b, b, *ratio * b};
  }
  const Vector3d axes = axis_last(*shape.semi_axes, axis_moved_last(shape));
  return literal ? axes : Vector3d(axes / std::cbrt(axes.prod()));
}

ed::BodyShape body_shape(const ShapeConfig& shape, bool literal) {
  const Vector3d axes = semi_axes_in_use(shape, literal);
  if (shape.kind == "superellipsoid") return geom::Superellipsoid(axes, shape.exponents.x(), shape.exponents.y());
  return geom::Ellipsoid(axes);
}

// ---- Inertia and mass

bool is_of_revolution(const ed::BodyShape& shape) {
  return std::holds_alternative<geom::Ellipsoid>(shape) && ed::symmetry_axis(shape);
}

Vector3d read_moments(const Entry& entry, std::string_view accepted) {
  Vector3d given = read_three(entry, accepted);
  // Those of a flat plate are at the limit, and decimals are rounded.
  if (!(given.maxCoeff() <= (given.sum() - given.maxCoeff()) * (1 + 1e-12))) throw bad(entry, accepted);
  return given;
}

const Entry* inertia_entry(const TomlDocument& document, const Place& place) {
  const Entry* entry = document.find(place.inertia);
  return entry != nullptr ? entry : document.find("dynamics.inertia");
}

void read_inertia(const TomlDocument& document, const Place& place, SpeciesConfig& species) {
  const bool round = is_of_revolution(species.body.shape);
  const std::string names = round ? "\"paper\", \"uniform\"" : "\"uniform\"";
  const std::string accepted = names +
                               " or three positive moments [I1, I2, I3] of which none exceeds the sum of the "
                               "other two";
  species.inertia = round ? "paper" : "uniform";
  const Entry* entry = inertia_entry(document, place);
  if (entry == nullptr) return;
  if (entry->value.kind != Value::Kind::text) {
    if (place.literal && entry->key == "dynamics.inertia") {
      throw bad(*entry, "\"paper\" or \"uniform\" for all species; moments in each [[species]]");
    }
    species.inertia_moments = read_moments(*entry, accepted);
    species.inertia = "moments";
    return;
  }
  if (entry->value.text == "paper" && !round) {
    throw InputError(fmt::format("{}: {} is \"paper\", which is for ellipsoids of revolution{}; accepted: {}",
                                 entry->where, entry->key,
                                 place.literal ? fmt::format(" and {} is none", place.section) : "", accepted));
  }
  if (entry->value.text != "paper" && entry->value.text != "uniform") throw bad(*entry, accepted);
  species.inertia = entry->value.text;
}

void read_mass(const TomlDocument& document, const Place& place, SpeciesConfig& species) {
  const Entry* entry = document.find(place.key("mass"));
  if (entry == nullptr) return;
  if (!is_number(entry->value) || !(entry->value.real >= kLightest && entry->value.real <= 1 / kLightest)) {
    throw bad(*entry, fmt::format("a number from {:g} to {:g}", kLightest, 1 / kLightest));
  }
  species.mass = entry->value.real;
}

ed::Species body_of(const SpeciesConfig& species) {
  const ed::BodyShape& shape = species.body.shape;
  if (species.inertia == "paper") return ed::paper_species(std::get<geom::Ellipsoid>(shape), species.mass);
  ed::Species body = ed::uniform_species(shape, species.mass);
  if (species.inertia == "moments") {
    body.inertia = axis_last(species.inertia_moments, axis_moved_last(species.shape));
  }
  return body;
}

/// The body with the axes in the order in which the config names them, as messages have to.
ed::Species as_named(const SpeciesConfig& species) {
  ed::Species body = species.body;
  const auto* ellipsoid = std::get_if<geom::Ellipsoid>(&body.shape);
  const int axis = axis_moved_last(species.shape);
  if (ellipsoid == nullptr || axis < 0) return body;
  const int back = (4 - axis) % 3;
  const Vector3d axes = axis_last(ellipsoid->semi_axes(), back);
  body.inertia = axis_last(body.inertia, back);
  body.shape = geom::Ellipsoid(axes);
  return body;
}

// ---- Numbers

std::int64_t sum_of_numbers(const std::vector<SpeciesConfig>& species) {
  return std::accumulate(species.begin(), species.end(), std::int64_t{0},
                         [](std::int64_t sum, const SpeciesConfig& s) { return sum + s.number; });
}

/// Each species says its number; [system] number may say the sum.
void take_numbers(const TomlDocument& document, Config& config) {
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    const std::string section = species_name(k);
    if (const Entry* fraction = document.find(section + ".fraction")) {
      const bool both = document.find(section + ".number") != nullptr;
      throw InputError(fmt::format("{}: {} is {}, while {} number; accepted: a number of each, or a fraction of each",
                                   fraction->where, fraction->key, fraction->value.shown,
                                   both ? "it also has a" : "other species have a"));
    }
    std::int64_t number = 0;
    read_integer(document, section + ".number", 1, kMostBodies, number);
    if (number == 0) {
      throw InputError(fmt::format("{}: {}.number is missing, while other species have one; accepted: a number of each",
                                   document.where_of(section), section));
    }
    config.species[k].number = static_cast<int>(number);
  }
  const std::int64_t sum = sum_of_numbers(config.species);
  const Entry* total = document.find("system.number");
  if (total != nullptr && sum != config.number) {
    throw bad(*total, fmt::format("{}, the sum of the species' numbers, or no system.number", sum));
  }
  if (sum < 2 || sum > kMostBodies) {
    throw bad(*document.find("species[1].number"), fmt::format("numbers that add up to 2 to {}", kMostBodies));
  }
  config.number = static_cast<int>(sum);
}

void read_fractions(const TomlDocument& document, std::vector<SpeciesConfig>& species) {
  double sum = 0;
  const Entry* entry = nullptr;
  for (std::size_t k = 0; k < species.size(); ++k) {
    entry = document.find(species_name(k) + ".fraction");
    if (entry == nullptr) {
      throw InputError(
          fmt::format("{}: {} has neither a fraction nor a number; accepted: a fraction of each, or a "
                      "number of each",
                      document.where_of(species_name(k)), species_name(k)));
    }
    if (!is_number(entry->value) || !(entry->value.real > 0 && entry->value.real <= 1)) {
      throw bad(*entry, "a number above 0, at most 1 (of the number of bodies)");
    }
    species[k].fraction = entry->value.real;
    sum += entry->value.real;
  }
  if (std::abs(sum - 1) <= kFractionRounding) return;
  throw InputError(
      fmt::format("{}: {} is {}, and the fractions of all species add up to {:g}; accepted: fractions "
                  "that add up to 1, to within {:g}",
                  entry->where, entry->key, entry->value.shown, sum, kFractionRounding));
}

/// Whole numbers by the fractions: rounded down, and the bodies left over go where most was cut off.
void apportion(int number, std::vector<SpeciesConfig>& species) {
  double sum = 0;
  for (const SpeciesConfig& s : species) sum += *s.fraction;
  std::vector<double> rest;
  for (SpeciesConfig& s : species) {
    const double share = number * (*s.fraction / sum);
    s.number = static_cast<int>(share);
    rest.push_back(share - s.number);
  }
  for (std::int64_t left = number - sum_of_numbers(species); left > 0; --left) {
    const auto most = std::max_element(rest.begin(), rest.end());
    species[static_cast<std::size_t>(most - rest.begin())].number += 1;
    *most = -1;
  }
}

void take_fractions(const TomlDocument& document, Config& config) {
  if (config.species.size() == 1 && document.find("species[1].fraction") == nullptr) {
    config.species[0].fraction = 1;
  } else {
    read_fractions(document, config.species);
  }
  apportion(config.number, config.species);
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    if (config.species[k].number > 0) continue;
    const Entry& fraction = *document.find(species_name(k) + ".fraction");
    throw InputError(
        fmt::format("{}: {} is {}, which is none of {} bodies; accepted: a fraction that gives at least "
                    "one, or a larger system.number",
                    fraction.where, fraction.key, fraction.value.shown, config.number));
  }
}

void read_numbers(const TomlDocument& document, Config& config) {
  std::int64_t number = config.number;
  read_integer(document, "system.number", 2, kMostBodies, number);
  config.number = static_cast<int>(number);
  if (!config.mixture) {
    config.species[0].number = config.number;
    return;
  }
  bool numbers = false;
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    numbers = numbers || document.find(species_name(k) + ".number") != nullptr;
  }
  numbers ? take_numbers(document, config) : take_fractions(document, config);
}

// ---- Sizes

ed::SizeDistribution distribution_of(const std::string& name) {
  if (name == "uniform") return ed::SizeDistribution::uniform;
  return name == "gaussian" ? ed::SizeDistribution::gaussian : ed::SizeDistribution::lognormal;
}

void read_sizes(const TomlDocument& document, const Place& place, SpeciesConfig& species) {
  read_choice(document, place.key("sizes"), {"equal", "uniform", "gaussian", "lognormal"}, species.sizes);
  const Entry* width = document.find(place.key("width"));
  const Entry* seed = document.find(place.key("size_seed"));
  if (species.sizes == "equal") {
    const Entry* extra = width != nullptr ? width : seed;
    if (extra == nullptr) return;
    throw bad(*extra, "none without sizes = \"uniform\", \"gaussian\" or \"lognormal\"");
  }
  const std::string accepted = fmt::format("a number above 0, at most {:g} (standard deviation / mean of the {} sizes)",
                                           ed::widest(distribution_of(species.sizes)), species.sizes);
  if (width == nullptr) {
    throw InputError(fmt::format("{}: {} is missing; accepted: {}", document.find(place.key("sizes"))->where,
                                 place.key("width"), accepted));
  }
  const double w = width->value.real;
  if (!is_number(width->value) || !(w > 0 && w <= ed::widest(distribution_of(species.sizes)))) {
    throw bad(*width, accepted);
  }
  species.width = w;
  if (seed != nullptr) {
    read_integer(document, seed->key, 0, std::numeric_limits<std::int64_t>::max(), species.size_seed.emplace());
  }
}

/// Each species draws from a stream of its own: its sizes do not depend on the other species, nor on the start.
void draw_all_sizes(Config& config) {
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    SpeciesConfig& species = config.species[k];
    if (species.sizes == "equal") continue;
    ed::Random streams(static_cast<std::uint64_t>(species.size_seed.value_or(config.seed)));
    for (std::size_t skip = 0; skip < k; ++skip) streams.bits();
    species.factors = ed::draw_sizes(distribution_of(species.sizes), species.width, species.number, streams.bits());
  }
}

// ---- Species

SpeciesConfig read_one(const TomlDocument& document, const Place& place) {
  SpeciesConfig species;
  read_shape(document, place, species.shape);
  species.body.shape = body_shape(species.shape, place.literal);
  read_inertia(document, place, species);
  if (place.literal) {
    read_mass(document, place, species);
    read_sizes(document, place, species);
  }
  species.body = body_of(species);
  try {
    ed::check_species(as_named(species));
  } catch (const std::invalid_argument& error) {
    const std::string why = error.what();
    const Entry* entry = inertia_entry(document, place);
    if (constexpr std::string_view kKey = "inertia"; entry != nullptr && why.starts_with(kKey)) {
      throw InputError(fmt::format("{}: {}{}", entry->where, entry->key, why.substr(kKey.size())));
    }
    throw InputError(fmt::format("{}: {}: {}", document.where_of(place.section), place.section, why));
  }
  return species;
}

/// Whichever stands later is one too many.
void refuse_both(const TomlDocument& document, const Entry& shape) {
  const Section* species = nullptr;
  for (const Section& section : document.sections) {
    if (section.name == "species[1]") species = &section;
  }
  const bool shape_later = shape.line == 0 || shape.line > species->line;
  throw InputError(
      fmt::format("{}: {} and [[species]] are both given; accepted: one [shape], or one or more "
                  "[[species]]",
                  shape_later ? shape.where : species->where, shape_later ? shape.key : "[shape]"));
}

/// What every species says itself would not count.
void refuse_unused_inertia(const TomlDocument& document, std::size_t number) {
  const Entry* entry = document.find("dynamics.inertia");
  if (entry == nullptr) return;
  for (std::size_t k = 0; k < number; ++k) {
    if (document.find(species_name(k) + ".inertia") == nullptr) return;
  }
  throw bad(*entry, "none where every [[species]] has its own inertia, or a [[species]] without one");
}

std::size_t number_of_species(const TomlDocument& document) {
  return static_cast<std::size_t>(
      std::count_if(document.sections.begin(), document.sections.end(), [](const Section& s) { return s.several; }));
}

}  // namespace

SizeStatistics statistics_of(const std::vector<double>& sizes) {
  const auto [smallest, largest] = std::minmax_element(sizes.begin(), sizes.end());
  const auto n = static_cast<double>(sizes.size());
  const double mean = std::accumulate(sizes.begin(), sizes.end(), 0.0) / n;
  double squares = 0;
  for (const double size : sizes) squares += (size - mean) * (size - mean);
  return {mean, std::sqrt(squares / std::max(1.0, n - 1)), *smallest, *largest};
}

std::string species_name(std::size_t index) {
  return fmt::format("species[{}]", index + 1);
}

std::optional<double> ShapeConfig::true_aspect_ratio() const {
  if (aspect_ratio) return *aspect_ratio;
  // From the axes as given: the rescaled ones would turn 3 into 2.9999999999999996.
  const int axis = axis_of_revolution(*this);
  if (axis < 0) return std::nullopt;
  return (*semi_axes)[axis] / (*semi_axes)[(axis + 1) % 3];
}

int SpeciesConfig::rotation_axes() const {
  return ed::symmetry_axis(body) ? 2 : 3;
}

Config with_number(Config config, int number) {
  const double factor = static_cast<double>(number) / config.number;
  if (config.species[0].fraction || !config.mixture) {
    config.number = number;
    if (config.mixture) apportion(number, config.species);
    if (!config.mixture) config.species[0].number = number;
  } else {
    for (SpeciesConfig& s : config.species) s.number = static_cast<int>(std::ceil(s.number * factor));
    config.number = static_cast<int>(sum_of_numbers(config.species));
  }
  draw_all_sizes(config);
  return config;
}

void read_species(const TomlDocument& document, Config& config) {
  const std::size_t number = number_of_species(document);
  config.mixture = number > 0;
  if (config.mixture) {
    const auto shape = std::find_if(document.entries.begin(), document.entries.end(),
                                    [](const Entry& e) { return e.key.starts_with("shape."); });
    if (shape != document.entries.end()) refuse_both(document, *shape);
    refuse_unused_inertia(document, number);
    for (std::size_t k = 0; k < number; ++k) {
      config.species.push_back(read_one(document, {species_name(k), species_name(k) + ".inertia", true}));
    }
  } else {
    config.species.push_back(read_one(document, {"shape", "dynamics.inertia", false}));
  }
  read_numbers(document, config);
  draw_all_sizes(config);
}

}  // namespace hardbody
