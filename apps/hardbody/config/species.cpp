#include "config/species.h"

#include "base/find.h"
#include "base/shapes.h"
#include "base/suggest.h"
#include "config/keys.h"
#include "config/shape_forms.h"

#include <ed/polydispersity.h>
#include <ed/random.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace hardbody {
namespace {

using Eigen::Vector3d;

constexpr double kFractionRounding = 1e-6;

// ---- Shape

/// Refuses keys of other kinds of shapes.
void check_keys_of_kind(const TomlDocument& document, const std::string& section, const ShapeForm& form) {
  for (const Entry& entry : document.entries) {
    if (section_of(entry.key) != section) continue;
    const std::string_view key = last_part(entry.key);
    const std::string kinds = kinds_with(key);
    if (kinds.empty() || form.has(key)) continue;
    throw bad(entry, fmt::format("no {} of {}, or kind = {}", key, with_article(form.kind), kinds));
  }
}

/// Refuses a shape with both of two keys of which one is needed, or neither.
void check_one_of(const TomlDocument& document, const std::string& section, const std::vector<std::string_view>& keys,
                  const Target& target) {
  std::vector<std::string> names;
  std::vector<const Entry*> found;
  for (const std::string_view key : keys) {
    names.push_back(fmt::format("{}.{}", section, key));
    if (const Entry* entry = document.find(names.back())) found.push_back(entry);
  }
  if (found.size() == 1) return;
  if (found.size() > 1) {
    const Entry& a = *found[0];
    const Entry& b = *found[1];
    const Entry& later = a.line != 0 && (b.line == 0 || b.line > a.line) ? b : a;
    throw InputError(fmt::format("{}: {} is {} and {} is {}; accepted: only one of them", later.where, a.key,
                                 a.value.shown, b.key, b.value.shown));
  }
  if (keys.size() == 1) {
    throw missing(document.where_of(section), names[0], target,
                  fmt::format(" of {}", with_article(target.species->shape.kind)));
  }
  throw InputError(fmt::format("{}: the section {} needs {} and has none; accepted: one of them",
                               document.where_of(section), target.config.mixture ? section : "[shape]",
                               fmt::join(names, " or ")));
}

/// Reads the shape of a section, whose other keys are read with it.
void read_shape_and_others(const TomlDocument& document, const std::string& section, const Target& target) {
  ShapeConfig& shape = target.species->shape;
  if (const Entry* kind = document.find(section + ".kind")) {
    read_entry(*kind, without_index(section) + ".kind", target);
  }
  const ShapeForm& form = form_of(shape.kind);
  check_keys_of_kind(document, section, form);
  for (const auto& keys : form.needed) check_one_of(document, section, keys, target);
  read_section(document, section, target);
  if (form.check == nullptr) return;
  const std::optional<ShapeRefusal> refusal = form.check(shape);
  if (refusal) throw bad(*document.find(fmt::format("{}.{}", section, refusal->key)), refusal->accepted, refusal->why);
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
  numbers.lengths = axis_last(numbers.lengths, back);
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
  read_shape_and_others(document, section, target);
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
  return body_shape(form_of(shape.kind).make(shape, literal));
}

SizeStatistics statistics_of(const std::vector<double>& sizes) {
  const auto [smallest, largest] = std::minmax_element(sizes.begin(), sizes.end());
  const auto n = static_cast<double>(sizes.size());
  const double mean = std::accumulate(sizes.begin(), sizes.end(), 0.0) / n;
  double squares = 0;
  for (const double size : sizes) squares += (size - mean) * (size - mean);
  return {mean, std::sqrt(squares / std::max(1.0, n - 1)), *smallest, *largest};
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
