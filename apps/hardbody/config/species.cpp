#include "config/species.h"

#include "base/find.h"
#include "base/shapes.h"
#include "config/keys.h"

#include <ed/polydispersity.h>
#include <ed/random.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace hardbody {
namespace {

using Eigen::Vector3d;

constexpr double kFractionRounding = 1e-6;

// ---- Shape

/// Returns the index of the axis of revolution in [a, b, c] (of a shape with equivalent axes); 2 for a sphere; -1:
/// there is none.
int axis_of_revolution(const Vector3d& axes) {
  if (axes.x() == axes.y()) return 2;
  if (axes.y() == axes.z()) return 0;
  return axes.x() == axes.z() ? 1 : -1;
}

/// Returns that index for the body that the user means.
int axis_of_revolution(const ShapeConfig& shape) {
  if (!shape.semi_axes) return 2;
  if (!has_equivalent_axes(shape.kind)) return shape.semi_axes->x() == shape.semi_axes->y() ? 2 : -1;
  return axis_of_revolution(*shape.semi_axes);
}

/// Returns the values about body x, y, z after the permutation that makes `axis` the z axis.
Vector3d axis_last(const Vector3d& v, int axis) {
  return axis < 0 ? v : Vector3d(v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]);
}

/// Refuses a shape with both an aspect ratio and semi-axes, or neither.
void check_one_of_lengths(const TomlDocument& document, const std::string& section, bool literal) {
  const std::string ratio_key = section + ".aspect_ratio";
  const std::string axes_key = section + ".semi_axes";
  const Entry* ratio = document.find(ratio_key);
  const Entry* axes = document.find(axes_key);
  if (ratio != nullptr && axes != nullptr) {
    const Entry& later = ratio->line != 0 && (axes->line == 0 || axes->line > ratio->line) ? *axes : *ratio;
    throw InputError(fmt::format("{}: {} is {} and {} is {}; accepted: only one of them", later.where, ratio->key,
                                 ratio->value.shown, axes->key, axes->value.shown));
  }
  if (ratio == nullptr && axes == nullptr) {
    throw InputError(fmt::format("{}: the section {} needs {} or {} and has none; accepted: one of them",
                                 document.where_of(section), literal ? section : "[shape]", ratio_key, axes_key));
  }
}

/// Returns the index of the axis in `semi_axes` that becomes body z; -1: all stay as they are given.
int axis_moved_last(const ShapeConfig& shape) {
  return has_equivalent_axes(shape.kind) ? axis_of_revolution(shape) : -1;
}

/// Returns the semi-axes in the program's units, an ellipsoid's axis of revolution last.
Vector3d semi_axes_in_use(const ShapeConfig& shape, bool literal) {
  const std::optional<double> ratio = shape.true_aspect_ratio();
  if (!shape.semi_axes || (ratio && !literal)) {
    const double b = 1 / std::cbrt(*ratio);
    return {b, b, *ratio * b};
  }
  const Vector3d axes = axis_last(*shape.semi_axes, axis_moved_last(shape));
  return literal ? axes : Vector3d(axes / std::cbrt(axes.prod()));
}

// ---- Inertia

/// Returns the inertia of a species: its own, or that for all.
const Entry* inertia_entry(const TomlDocument& document, const std::string& section) {
  const Entry* entry = document.find(section + ".inertia");
  return entry != nullptr ? entry : document.find(kInertiaKey);
}

void read_inertia(const TomlDocument& document, const std::string& section, const Target& target) {
  SpeciesConfig& species = *target.species;
  species.inertia = ed::is_spheroid(species.body.shape) ? Inertia::paper : Inertia::uniform;
  const Entry* entry = inertia_entry(document, section);
  if (entry == nullptr) return;
  if (target.config.mixture && entry->key == kInertiaKey && entry->value.kind != Value::Kind::text) {
    throw bad(*entry, "\"paper\" or \"uniform\" for all species; moments in each [[species]]");
  }
  read_entry(*entry, kInertiaKey, target);
}

ed::Species body_of(const SpeciesConfig& species) {
  const ed::BodyShape& shape = species.body.shape;
  if (species.inertia == Inertia::paper) return ed::paper_species(std::get<geom::Ellipsoid>(shape), species.mass);
  ed::Species body = ed::uniform_species(shape, species.mass);
  if (species.inertia == Inertia::moments) {
    body.inertia = axis_last(species.inertia_moments, axis_moved_last(species.shape));
  }
  return body;
}

/// Returns the body with the axes in the order in which the config names them, as messages have to.
ed::Species as_named(const SpeciesConfig& species) {
  ed::Species body = species.body;
  const int axis = axis_moved_last(species.shape);
  if (axis < 0) return body;
  const int back = (4 - axis) % 3;
  ShapeNumbers numbers = numbers_of(body.shape);
  numbers.semi_axes = axis_last(numbers.semi_axes, back);
  body.inertia = axis_last(body.inertia, back);
  body.shape = make_body_shape(numbers);
  return body;
}

// ---- Numbers

std::int64_t sum_of_numbers(const std::vector<SpeciesConfig>& species) {
  return std::accumulate(species.begin(), species.end(), std::int64_t{0},
                         [](std::int64_t sum, const SpeciesConfig& s) { return sum + s.number; });
}

/// Takes the number that each species says; [system] number may say the sum.
void take_numbers(const TomlDocument& document, Config& config) {
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    const std::string section = species_name(k);
    if (const Entry* fraction = document.find(section + ".fraction")) {
      const bool both = document.find(section + ".number") != nullptr;
      throw bad(*fraction, "a number of each, or a fraction of each",
                both ? ", while it also has a number" : ", while other species have a number");
    }
    if (config.species[k].number == 0) {
      throw InputError(fmt::format("{}: {}.number is missing, while other species have one; accepted: a number of each",
                                   document.where_of(section), section));
    }
  }
  const std::int64_t sum = sum_of_numbers(config.species);
  const Entry* total = document.find(kNumberKey);
  if (total != nullptr && sum != config.number) {
    throw bad(*total, fmt::format("{}, the sum of the species' numbers, or no {}", sum, kNumberKey));
  }
  if (sum < 2 || sum > kMostBodies) {
    throw bad(*document.find("species[1].number"), fmt::format("numbers that add up to 2 to {}", kMostBodies));
  }
  config.number = static_cast<int>(sum);
}

void check_fractions(const TomlDocument& document, const std::vector<SpeciesConfig>& species) {
  double sum = 0;
  for (std::size_t k = 0; k < species.size(); ++k) {
    if (!species[k].fraction) {
      throw InputError(
          fmt::format("{}: {} has neither a fraction nor a number; accepted: a fraction of each, or a number of each",
                      document.where_of(species_name(k)), species_name(k)));
    }
    sum += *species[k].fraction;
  }
  if (std::abs(sum - 1) <= kFractionRounding) return;
  throw bad(*document.find(species_name(species.size() - 1) + ".fraction"),
            fmt::format("fractions that add up to 1, to within {:g}", kFractionRounding),
            fmt::format(", and the fractions of all species add up to {:g}", sum));
}

/// Makes whole numbers of the fractions: rounded down, and the bodies left over go where most was cut off.
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
  if (config.species.size() == 1 && !config.species[0].fraction) config.species[0].fraction = 1;
  check_fractions(document, config.species);
  apportion(config.number, config.species);
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    if (config.species[k].number > 0) continue;
    throw bad(*document.find(species_name(k) + ".fraction"),
              fmt::format("a fraction that gives at least one, or a larger {}", kNumberKey),
              fmt::format(", which is none of {} bodies", config.number));
  }
}

void read_numbers(const TomlDocument& document, Config& config) {
  read_key(document, kNumberKey, {config});
  if (!config.mixture) {
    config.species[0].number = config.number;
    return;
  }
  const bool numbers =
      std::any_of(config.species.begin(), config.species.end(), [](const SpeciesConfig& s) { return s.number > 0; });
  numbers ? take_numbers(document, config) : take_fractions(document, config);
}

// ---- Sizes

/// Draws the sizes of each species from a stream of its own: they do not depend on the other species, nor on the start.
void draw_all_sizes(Config& config) {
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    SpeciesConfig& species = config.species[k];
    if (!species.sizes) continue;
    ed::Random streams(static_cast<std::uint64_t>(species.size_seed.value_or(config.seed)));
    for (std::size_t skip = 0; skip < k; ++skip) streams.bits();
    species.factors = ed::draw_sizes(*species.sizes, species.width, species.number, streams.bits());
  }
}

// ---- Species

void read_one(const TomlDocument& document, const std::string& section, Config& config) {
  SpeciesConfig& species = config.species.emplace_back();
  const Target target{config, &species};
  check_one_of_lengths(document, section, config.mixture);
  read_section(document, section, target);
  if (has_exponents(species.shape.kind) && document.find(section + ".exponents") == nullptr) {
    throw missing(document.where_of(section), section + ".exponents", target,
                  fmt::format(" of a {}", to_string(species.shape.kind)));
  }
  if (species.sizes && document.find(section + ".width") == nullptr) {
    throw missing(document.find(section + ".sizes")->where, section + ".width", target);
  }
  species.body.shape = body_shape(species.shape, config.mixture);
  read_inertia(document, section, target);
  species.body = body_of(species);
  try {
    ed::check_species(as_named(species));
  } catch (const std::invalid_argument& error) {
    const std::string why = error.what();
    const Entry* entry = inertia_entry(document, section);
    if (constexpr std::string_view kKey = "inertia"; entry != nullptr && why.starts_with(kKey)) {
      throw InputError(fmt::format("{}: {}{}", entry->where, entry->key, why.substr(kKey.size())));
    }
    throw InputError(fmt::format("{}: {}: {}", document.where_of(section), section, why));
  }
}

/// Refuses [shape] or [[species]], whichever stands later.
void refuse_both(const TomlDocument& document, const Entry& shape) {
  const Section* species = find_by(document.sections, &Section::name, "species[1]");
  const bool shape_later = shape.line == 0 || shape.line > species->line;
  throw InputError(
      fmt::format("{}: {} and [[species]] are both given; accepted: one [shape], or one or more [[species]]",
                  shape_later ? shape.where : species->where, shape_later ? shape.key : "[shape]"));
}

/// Refuses an inertia for all where every species has its own.
void refuse_unused_inertia(const TomlDocument& document, std::size_t number) {
  const Entry* entry = document.find(kInertiaKey);
  if (entry == nullptr) return;
  for (std::size_t k = 0; k < number; ++k) {
    if (document.find(species_name(k) + ".inertia") == nullptr) return;
  }
  throw bad(*entry, "none where every [[species]] has its own inertia, or a [[species]] without one");
}

}  // namespace

ed::BodyShape body_shape(const ShapeConfig& shape, bool literal) {
  const Vector3d axes = semi_axes_in_use(shape, literal);
  return make_body_shape({shape.kind, axes, shape.exponents});
}

SizeStatistics statistics_of(const std::vector<double>& sizes) {
  const auto [smallest, largest] = std::minmax_element(sizes.begin(), sizes.end());
  const auto n = static_cast<double>(sizes.size());
  const double mean = std::accumulate(sizes.begin(), sizes.end(), 0.0) / n;
  double squares = 0;
  for (const double size : sizes) squares += (size - mean) * (size - mean);
  return {mean, std::sqrt(squares / std::max(1.0, n - 1)), *smallest, *largest};
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
  const auto number = static_cast<std::size_t>(
      std::count_if(document.sections.begin(), document.sections.end(), [](const Section& s) { return s.several; }));
  config.mixture = number > 0;
  if (config.mixture) {
    const auto shape = std::find_if(document.entries.begin(), document.entries.end(),
                                    [](const Entry& e) { return e.key.starts_with("shape."); });
    if (shape != document.entries.end()) refuse_both(document, *shape);
    refuse_unused_inertia(document, number);
    for (std::size_t k = 0; k < number; ++k) read_one(document, species_name(k), config);
  } else {
    read_one(document, "shape", config);
  }
  read_numbers(document, config);
  draw_all_sizes(config);
}

}  // namespace hardbody
