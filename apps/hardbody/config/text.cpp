#include "config/text.h"

#include "base/version.h"
#include "io/toml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <variant>

namespace hardbody {
namespace {

constexpr const char* kUnits =
    "# Units: kT = m = 1 and length l = (a b c)^(1/3) = 1, a, b, c the semi-axes; time in l sqrt(m/kT).\n"
    "# In these units a sphere has radius 1.\n";
constexpr const char* kMixtureUnits =
    "# Units: kT = 1; lengths and masses as the species give them: l and m are those units; time in l sqrt(m/kT).\n";

std::string list(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", toml_real(v.x()), toml_real(v.y()), toml_real(v.z()));
}

std::string quoted(const std::string& text) {
  Value value;
  value.kind = Value::Kind::text;
  value.text = text;
  return toml_text(value);
}

std::string names(const std::vector<std::string>& list) {
  std::string text;
  for (const std::string& name : list) text += (text.empty() ? "" : ", ") + quoted(name);
  return "[" + text + "]";
}

std::string numbers(const std::vector<double>& list) {
  std::string text;
  for (const double x : list) text += (text.empty() ? "" : ", ") + toml_real(x);
  return "[" + text + "]";
}

std::string time(const std::optional<double>& t) {
  return t ? toml_real(*t) : quoted("auto");
}

/// A key with its comment, or a further line of the comment.
std::string line(const char* key, const std::string& value, const std::string& comment) {
  return fmt::format("{:<31} # {}\n", fmt::format("{} = {}", key, value), comment);
}
std::string more(std::string_view comment) {
  return fmt::format("{:<32}# {}\n", "", comment);
}

std::string list(const Eigen::Vector2d& v) {
  return fmt::format("[{}, {}]", toml_real(v.x()), toml_real(v.y()));
}

std::string exponents_text(const ShapeConfig& shape) {
  if (shape.kind != "superellipsoid") return "";
  return line("exponents", list(shape.exponents),
              "[e1, e2], of the profile along z and of the section across it: 1 an") +
         more("ellipsoid, towards 0.25 a box, towards 1.6 an octahedron. The superball") +
         more("|x|^p + |y|^p + |z|^p = a^p has a = b = c and e1 = e2 = 2/p");
}

std::string kind_text(const ShapeConfig& shape) {
  return line("kind", quoted(shape.kind), "\"ellipsoid\", or \"superellipsoid\" with exponents");
}

std::string ratio_text(const ShapeConfig& shape) {
  return line("aspect_ratio", toml_real(*shape.aspect_ratio),
              "X0 = a/b, a along the axis of revolution, from 0.01 to 100;");
}

std::string shape_text(const SpeciesConfig& species) {
  const ShapeConfig& shape = species.shape;
  std::string text = "\n[shape]\n" + kind_text(shape);
  if (shape.aspect_ratio) {
    text += ratio_text(shape) + more("or semi_axes = [a, b, c], in any unit: only their ratios count");
  } else {
    const Eigen::Vector3d used = ed::half_extents(species.body.shape);
    const bool last = shape.kind == "ellipsoid" && shape.true_aspect_ratio();
    text += line("semi_axes", list(*shape.semi_axes), "in any unit: only their ratios count;") +
            more(fmt::format("in use, l = 1{}: {:.6g}, {:.6g}, {:.6g}", last ? " and the axis of revolution last" : "",
                             used.x(), used.y(), used.z()));
  }
  return text + exponents_text(shape);
}

std::string inertia_text(const SpeciesConfig& species) {
  const bool paper =
      std::holds_alternative<geom::Ellipsoid>(species.body.shape) && ed::symmetry_axis(species.body.shape);
  const std::string value = species.inertia == "moments" ? list(species.inertia_moments) : quoted(species.inertia);
  constexpr const char* kMoments = "about the axes as semi_axes names them, in m l^2, with spin";
  if (!paper) {
    return line("inertia", value, "\"uniform\": uniform density; or moments [I1, I2, I3]") + more(kMoments);
  }
  return line("inertia", value, "\"paper\": 2/5 m min(a,b)^2, no spin about the axis of revolution;") +
         more("\"uniform\": uniform density, with spin; or moments [I1, I2, I3]") + more(kMoments);
}

std::string sizes_text(const SpeciesConfig& species) {
  std::string text =
      line("sizes", quoted(species.sizes), "of the bodies: \"equal\", or of mean 1 (the semi-axes above)") +
      more("and \"uniform\", \"gaussian\" or \"lognormal\" with a width");
  if (species.sizes == "equal") return text;
  text +=
      line("width", toml_real(species.width), "standard deviation / mean; the tails beyond 3 of them are cut off.") +
      more("Mass goes with the volume: all have the same density");
  const SizeStatistics drawn = statistics_of(species.factors);
  text += more(fmt::format("drawn: {:.4g} to {:.4g}", drawn.smallest, drawn.largest));
  if (species.size_seed)
    text += line("size_seed", fmt::format("{}", *species.size_seed), "of the sizes, instead of seed");
  return text;
}

std::string species_text(const SpeciesConfig& species) {
  const std::string number =
      species.fraction
          ? line("fraction", toml_real(*species.fraction),
                 fmt::format("of the bodies, {} of them; or number", species.number))
          : line("number", fmt::format("{}", species.number), "of bodies; or a fraction of [system] number");
  const ShapeConfig& shape = species.shape;
  return "\n[[species]]\n" + kind_text(shape) +
         (shape.aspect_ratio ? ratio_text(shape) + more("or semi_axes; (a b c)^(1/3) = 1 then")
                             : line("semi_axes", list(*shape.semi_axes), "[a, b, c], as they are")) +
         exponents_text(shape) + number + line("mass", toml_real(species.mass), "of a body of nominal size") +
         inertia_text(species) + sizes_text(species);
}

std::string start_text(const Config& config) {
  if (config.start_file) return "";
  std::string text =
      line("start", quoted(config.start), "at random and compressed; or on a lattice, \"cubic\" or \"fcc\",") +
      more("stretched to the bodies' proportions, the bodies aligned");
  if (config.start_from) {
    text += line("start_from", quoted(*config.start_from), "instead: the last state of that run, compressed");
  } else if (config.nematic_order) {
    text += line("nematic_order", toml_real(*config.nematic_order),
                 config.start == "random" ? "S about z, before the compression, which lets it relax" : "S about z");
  } else {
    text += more("nematic_order = S: orientations of that order parameter, which a lattice") +
            more("keeps and compression from \"random\" loses;") +
            more("start_from = \"DIR\" instead: the last state of that run, compressed");
  }
  return text;
}

std::string start_file_text(const Config& config) {
  if (!config.start_file) return "";
  std::string text = "\n[start]\n" + line("file", quoted(config.start_file->file), "GSD, or LAMMPS text dump");
  if (config.start_file->frame) text += line("frame", fmt::format("{}", *config.start_file->frame), "from 0");
  text += line("mend", config.start_file->mend ? "true" : "false",
               "overlaps, by scaling box and positions; else they are refused");
  return text + line("reverse", config.start_file->reverse ? "true" : "false", "all velocities negated");
}

std::string bodies_text(const Config& config) {
  if (!config.mixture) return shape_text(config.species[0]);
  std::string text;
  for (const SpeciesConfig& species : config.species) text += species_text(species);
  return text;
}

std::string dynamics_text(const Config& config) {
  return "\n[dynamics]\n" + (config.mixture ? std::string() : inertia_text(config.species[0])) +
         line("finder", quoted(config.finder), "of contact times: \"certified\", or \"bracketing\" (the paper's)") +
         line("eps_d", toml_real(config.eps_d), "in l, for \"bracketing\": shallower contacts may be missed") +
         line("distance", quoted(config.distance), "for \"bracketing\": \"dual\", \"newton8\" or \"newton5\"") +
         line("neighbours", quoted(config.neighbours),
              "lists: \"auto\", \"dilated\", \"obp\" (the paper's) or \"cells\"");
}

std::string times_text(const Config& config) {
  return "\n[equilibration]\n" +
         line("time", time(config.equilibration_time),
              "in l sqrt(m/kT); \"auto\": until C2 and F_self have decayed below") +
         more("0.05 twice in a row, and Z and S do not drift") +
         line("cap", toml_real(config.equilibration_cap), "of \"auto\": the state counts as not equilibrated then") +
         "\n[production]\n" +
         line("time", time(config.production_time),
              fmt::format("in l sqrt(m/kT); \"auto\": 30 times the equilibration, from {:g}",
                          kLeastProduction * config.time_unit)) +
         more(fmt::format("to {:g}; or until the relative errors of D_trans and D_rot are",
                          kMostProduction * config.time_unit)) +
         (config.target_error ? line("target_error", toml_real(*config.target_error), "at most this")
                              : more("target_error = 0.02, if that is given")) +
         line("wave_numbers", numbers(config.wave_numbers),
              "of F_self, in 1/l, at most 8, the first is fitted; none: at") +
         more("the first peak of S(q), a quarter, half and twice of it");
}

std::string output_text(const Config& config) {
  return "\n[output]\n" +
         line("events", fmt::format("{}", config.events), "so many collisions of production go to events.csv") +
         line("trajectory", names(config.trajectory), "of production: any of \"gsd\", \"lammps\" and \"vtk\"") +
         line("frames", fmt::format("{}", config.frames), "of each, evenly from the begin to the end") +
         line("checkpoint_every", quoted(config.checkpoint_every),
              "of checkpoint.bin: a number and s, m or h; it is also written at") +
         more("the end, and when the run is stopped");
}

struct Template {
  std::string_view name;
  const char* bodies;
  std::string_view config;
};

constexpr std::string_view kSweepTemplate = "sweep";

constexpr Template kTemplates[] = {
    {"ellipsoid", "hard ellipsoids", "[system]\npacking_fraction = 0.4\n[shape]\naspect_ratio = 3\n"},
    {"superball", "hard superballs, |x|^4 + |y|^4 + |z|^4 = a^4",
     "[system]\npacking_fraction = 0.4\n[shape]\nkind = \"superellipsoid\"\nsemi_axes = [1, 1, 1]\n"
     "exponents = [0.5, 0.5]\n"},
    {"mixture", "a mixture: rods, and spheres of several sizes",
     "[system]\npacking_fraction = 0.3\n"
     "[[species]]\nsemi_axes = [0.5, 0.5, 1.5]\nfraction = 0.75\n"
     "[[species]]\nsemi_axes = [0.8, 0.8, 0.8]\nfraction = 0.25\nsizes = \"gaussian\"\nwidth = 0.1\n"},
};

}  // namespace

std::string config_text(const Config& config, const std::string& header) {
  return header + (config.mixture ? kMixtureUnits : kUnits) + "\n" +
         line("seed", fmt::format("{}", config.seed), "of the start: an integer, at least 0") + "\n[system]\n" +
         line("number", fmt::format("{}", config.number), "of bodies, in a periodic cubic box") +
         line("packing_fraction", toml_real(config.packing_fraction), "volume of the bodies / volume of the box") +
         start_text(config) + start_file_text(config) + bodies_text(config) + dynamics_text(config) +
         times_text(config) + output_text(config);
}

namespace {

/// A run's config with a grid at its end.
std::string sweep_template() {
  Config config = parse_config(kTemplates[0].config, "template");
  config.neighbours = "auto";
  return config_text(
             config,
             "# hardbody: a sweep, a run at every point of a grid. Start it, or go on with it, with: hardbody sweep "
             "THIS_FILE\n"
             "# The config is that of hardbody run; the keys in [grid], at the end, take each of their values "
             "instead.\n"
             "# base = \"run.toml\", instead of all that is not in [grid], takes it from that file.\n"
             "# chain = \"system.packing_fraction\": denser points start from the last state of the one before.\n") +
         "\n# Every combination of the values; those of the last key change fastest.\n"
         "[grid]\n" +
         "shape.aspect_ratio = [0.5, 1.0, 2.0, 3.0]                        # a list of values, or a single one\n"
         "system.packing_fraction = {from = 0.2, to = 0.4, step = 0.05}    # a range, both ends included; or {from, "
         "to,\n"
         "# count}: so many values, evenly spaced, or by equal factors with spacing = \"log\".\n"
         "# zip = [\"key\", \"other key\"] walks their lists together, instead of combining each with each.\n"
         "# [[grid]], several times: one grid after the other, of the same keys.\n";
}

}  // namespace

std::optional<std::string> template_text(std::string_view name) {
  if (name == kSweepTemplate) return sweep_template();
  const auto found =
      std::find_if(std::begin(kTemplates), std::end(kTemplates), [&](const Template& t) { return t.name == name; });
  if (found == std::end(kTemplates)) return std::nullopt;
  Config config = parse_config(found->config, "template");
  config.neighbours = "auto";
  return config_text(config, fmt::format("# hardbody: a run of {}. Start it with: hardbody run THIS_FILE\n"
                                         "# Only packing_fraction and the shape are needed; the other values are the "
                                         "defaults.\n",
                                         found->bodies));
}

std::string template_names() {
  std::string names;
  for (const Template& t : kTemplates) names += std::string(t.name) + ", ";
  return names + std::string(kSweepTemplate);
}

std::string resolved_text(const Config& config) {
  return config_text(config,
                     fmt::format("# hardbody {}: the configuration of this run, defaults filled in.\n", version()));
}

}  // namespace hardbody
