#include "config/keys.h"

#include "config/rules.h"
#include "config/species.h"

#include <ed/polydispersity.h>
#include <ed/shape.h>
#include <ed/tolerances.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

namespace hardbody {
namespace {

constexpr double kLeastPacking = 1e-9;
/// Largest packing fraction of a lattice or a start from a file; the number of bodies of a lattice may allow less.
constexpr double kDensestLattice = 0.9999;
constexpr double kLightest = 1e-6;  ///< the heaviest is the inverse

// ---- [system] and [start]

Taken take_packing(const Value& value, const Place& at, double& result) {
  const Config& config = at.config;
  const bool ordered = config.lattice() || config.start_file;
  const double densest = ordered ? kDensestLattice : ed::densest_start(config.components());
  if (is_number(value) && value.real >= kLeastPacking && value.real <= densest) {
    result = value.real;
    return std::nullopt;
  }
  // Rounded down: the value that the message names is accepted.
  return Refusal{fmt::format("a number from {:g} to {:.4f} for {}", kLeastPacking, std::floor(densest * 1e4) / 1e4,
                             config.start_file  ? "a start from a file"
                             : config.lattice() ? "a lattice"
                             : config.mixture   ? "these shapes"
                                                : "this shape")};
}

constexpr auto is_name = [](const std::string& text) { return !text.empty(); };
constexpr auto all_spheres = [](const Place& at) {
  return std::all_of(at.config.species.begin(), at.config.species.end(), is_sphere);
};
constexpr auto without_file = [](const Place& at) { return !at.config.start_file; };
constexpr auto order_comment = [](const Place& at) -> std::string {
  return at.config.start ? "S about z" : "S about z, before the compression, which lets it relax";
};

std::vector<Key> system_keys() {
  return {
      {kSeedKey, "1", integer(&Config::seed, 0), "of the start: an integer, at least 0"},
      {kNumberKey, "512", integer(&Config::number, 2, kMostBodies), "of bodies, in a periodic cubic box"},
      {kPackingKey, "required, except with [start] file", bound(&Config::packing_fraction, take_packing),
       "volume of the bodies / volume of the box"},
      {kStartKey, "\"random\"",
       choice(&Config::start, {std::nullopt, ed::Lattice::simple_cubic, ed::Lattice::fcc}, "random"),
       "at random and compressed; or on a lattice, \"cubic\" or \"fcc\",\n"
       "stretched to the bodies' proportions, the bodies aligned",
       without_file},
      {kOrderKey, "",
       unless(all_spheres, "no key nematic_order: spheres have no orientation",
              number(&Config::nematic_order, {0, 1, true, false}, "the order parameter S of the start")),
       order_comment, [](const Place& at) { return without_file(at) && !at.config.start_from; },
       "nematic_order = S: orientations of that order parameter, which a lattice\n"
       "keeps and compression from \"random\" loses;"},
      {kStartFromKey, "", text(&Config::start_from, is_name, "the directory of a run"),
       "instead: the last state of that run, compressed",
       [](const Place& at) { return without_file(at) && !at.config.nematic_order; },
       "start_from = \"DIR\" instead: the last state of that run, compressed"},
      {kStartFileKey, "", text(&StartFile::file, is_name, "the name of a file"), "GSD, or LAMMPS text dump"},
      {kStartFrameKey, "the last", integer(&StartFile::frame, 0), "from 0"},
      {kMendKey, "false", flag(&StartFile::mend), "overlaps, by scaling box and positions; else they are refused"},
      {"start.reverse", "false", flag(&StartFile::reverse), "all velocities negated"},
  };
}

// ---- [shape] and [[species]]

Taken take_inertia(const Value& value, const Place& at, Inertia& result, Eigen::Vector3d& moments) {
  const bool paper = ed::is_spheroid(body_shape(at.species->shape, at.config.mixture));
  if (value.kind == Value::Kind::text && (value.text == "uniform" || (value.text == "paper" && paper))) {
    result = value.text == "paper" ? Inertia::paper : Inertia::uniform;
    return std::nullopt;
  }
  // Those of a flat plate are at the limit, and decimals are rounded.
  if (take_positive(value, moments) && moments.maxCoeff() <= (moments.sum() - moments.maxCoeff()) * (1 + 1e-12)) {
    result = Inertia::moments;
    return std::nullopt;
  }
  const auto index = static_cast<std::size_t>(at.species - at.config.species.data());
  const std::string which = at.config.mixture ? fmt::format(" and {} is none", species_name(index)) : "";
  return Refusal{
      std::string(paper ? "\"paper\", " : "") +
          "\"uniform\" or three positive moments [I1, I2, I3] of which none exceeds the sum of the other two",
      value.text == "paper" ? ", which is for ellipsoids of revolution" + which : ""};
}

Rule inertia_rule() {
  return {[](const Value& value, const Target& to) {
            return take_inertia(value, to, to.species->inertia, to.species->inertia_moments);
          },
          [](const Place& at) {
            const SpeciesConfig& species = *at.species;
            return species.inertia == Inertia::moments ? value_text(species.inertia_moments)
                                                       : value_text(species.inertia);
          },
          [](const Place& a, const Place& b) {
            return a.species->inertia == b.species->inertia && a.species->inertia_moments == b.species->inertia_moments;
          }};
}

std::string inertia_comment(const Place& at) {
  const char* const moments = has_semi_axes(at.species->shape.kind)
                                  ? "\nabout the axes as semi_axes names them, in m l^2, with spin"
                                  : "\nabout the body's axes, in m l^2, with spin";
  constexpr const char* kPaper =
      "\"paper\": 2/5 m min(a,b)^2, no spin about the axis of revolution;\n"
      "\"uniform\": uniform density, with spin; or moments [I1, I2, I3]";
  constexpr const char* kUniform = "\"uniform\": uniform density; or moments [I1, I2, I3]";
  return std::string(ed::is_spheroid(at.species->body.shape) ? kPaper : kUniform) + moments;
}

using Sizes = ed::SizeDistribution;

constexpr auto without_sizes = [](const Place& at) { return !at.species->sizes; };
constexpr auto has_sizes = [](const Place& at) { return at.species->sizes.has_value(); };
constexpr const char* kNoSizes = "none without sizes = \"uniform\", \"gaussian\" or \"lognormal\"";

Taken take_width(const Value& value, const Place& at, double& result) {
  const Sizes sizes = *at.species->sizes;
  return take_number(value, {0, ed::widest(sizes), false},
                     fmt::format("standard deviation / mean of the {} sizes", ed::to_string(sizes)), result);
}

std::string width_comment(const Place& at) {
  const SizeStatistics drawn = statistics_of(at.species->factors);
  return fmt::format(
      "standard deviation / mean; the tails beyond 3 of them are cut off.\n"
      "Mass goes with the volume: all have the same density\ndrawn: {:.4g} to {:.4g}",
      drawn.smallest, drawn.largest);
}

constexpr auto fraction_comment = [](const Place& at) -> std::string {
  return fmt::format("of the bodies, {} of them; or number", at.species->number);
};

std::vector<Key> shape_keys() {
  return form_keys("shape");
}

std::vector<Key> species_keys() {
  std::vector<Key> keys = form_keys("species");
  const std::vector<Key> others = {
      {"species.fraction", "1 for a single species",
       number(&SpeciesConfig::fraction, {0, 1, false}, "of the number of bodies"), fraction_comment},
      {"species.number", "1 for a single species", integer(&SpeciesConfig::number, 1, kMostBodies),
       "of bodies; or a fraction of [system] number", [](const Place& at) { return !at.species->fraction; }},
      {"species.mass", "1", number(&SpeciesConfig::mass, {kLightest, 1 / kLightest}), "of a body of nominal size"},
      {"species.inertia", "that of [dynamics]", inertia_rule(), inertia_comment},
      {"species.sizes", "\"equal\"",
       choice(&SpeciesConfig::sizes, {std::nullopt, Sizes::uniform, Sizes::gaussian, Sizes::lognormal}, "equal"),
       "of the bodies: \"equal\", or of mean 1 (the lengths above)\n"
       "and \"uniform\", \"gaussian\" or \"lognormal\" with a width"},
      {"species.width", "required with sizes",
       unless(without_sizes, kNoSizes, bound(&SpeciesConfig::width, take_width)), width_comment, has_sizes},
      {"species.size_seed", "the run's seed", unless(without_sizes, kNoSizes, integer(&SpeciesConfig::size_seed, 0)),
       "of the sizes, instead of seed", has_sizes},
  };
  keys.insert(keys.end(), others.begin(), others.end());
  return keys;
}

// ---- [dynamics]

Taken take_eps_d(const Value& value, const Place& at, double& result) {
  double limit = std::numeric_limits<double>::infinity();
  for (const ed::Component& c : at.config.components()) limit = std::min(limit, ed::inscribed_radius(c.species.shape));
  result = value.real;
  return is_number(value) && result > 0 && result < limit
             ? Taken()
             : Refusal{fmt::format("a number above 0 and below the smallest semi-axis, {:.4g}", limit)};
}

std::vector<Key> dynamics_keys() {
  return {
      {kInertiaKey, "see inertia", inertia_rule(), inertia_comment, [](const Place& at) { return !at.config.mixture; }},
      {kFinderKey, "\"certified\"", choice(&Config::finder, {ed::Finder::certified, ed::Finder::bracketing}),
       "of contact times: \"certified\", or \"bracketing\" (the paper's)"},
      {"dynamics.eps_d", "1e-6 of the bodies' mean size", bound(&Config::eps_d, take_eps_d),
       "in l, for \"bracketing\": shallower contacts may be missed"},
      {kDistanceKey, "\"dual\"",
       choice(&Config::distance, {ed::DistanceMethod::dual, ed::DistanceMethod::newton8, ed::DistanceMethod::newton5}),
       "for \"bracketing\": \"dual\", \"newton8\" or \"newton5\""},
      {"dynamics.neighbours", "\"auto\"",
       choice(&Config::neighbours, {std::nullopt, ed::Neighbours::dilated, ed::Neighbours::obp, ed::Neighbours::cells},
              "auto"),
       "lists: \"auto\", \"dilated\", \"obp\" (the paper's) or \"cells\""},
  };
}

}  // namespace

const std::vector<Key>& keys() {
  static const std::vector<Key> table = [] {
    std::vector<Key> all;
    for (const auto make : {system_keys, shape_keys, species_keys, dynamics_keys, run_keys}) {
      std::vector<Key> some = make();
      std::move(some.begin(), some.end(), std::back_inserter(all));
    }
    return all;
  }();
  return table;
}

}  // namespace hardbody
