#include "config_text.h"

#include "toml_document.h"
#include "version.h"

#include <fmt/format.h>

#include <string_view>

namespace hardbody {
namespace {

constexpr const char* kUnits =
    "# Units: kT = m = 1 and length l = (a b c)^(1/3) = 1, a, b, c the semi-axes; time in l sqrt(m/kT).\n"
    "# In these units a sphere has radius 1.\n";

std::string list(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", toml_real(v.x()), toml_real(v.y()), toml_real(v.z()));
}

std::string quoted(const std::string& text) {
  return fmt::format("\"{}\"", text);
}

std::string time(const std::optional<double>& t) {
  return t ? toml_real(*t) : quoted("auto");
}

/// A key with its comment, or a further line of the comment.
std::string line(const char* key, const std::string& value, const char* comment) {
  return fmt::format("{:<32}# {}\n", fmt::format("{} = {}", key, value), comment);
}
std::string more(std::string_view comment) {
  return fmt::format("{:<32}# {}\n", "", comment);
}

std::string shape_text(const Config& config) {
  std::string text = "\n[shape]\n" + line("kind", quoted("ellipsoid"), "of revolution");
  if (!config.semi_axes) {
    return text +
           line("aspect_ratio", toml_real(config.aspect_ratio.value_or(1)),
                "X0 = a/b, a along the axis of revolution, from 0.01 to 100;") +
           more("or semi_axes = [1, 1, 3], in any unit, two of them equal");
  }
  const Eigen::Vector3d& used = config.species.shape.semi_axes();
  return text + line("semi_axes", list(*config.semi_axes), "in any unit: only their ratio counts; in use (l = 1, the") +
         more(fmt::format("axis of revolution last): {:.6g}, {:.6g}, {:.6g}", used.x(), used.y(), used.z()));
}

std::string dynamics_text(const Config& config) {
  const bool moments = config.inertia == "moments";
  return "\n[dynamics]\n" +
         line("inertia", moments ? list(config.inertia_moments) : quoted(config.inertia),
              "\"paper\": 2/5 m min(a,b)^2, no spin about the axis of revolution;") +
         more("\"uniform\": uniform density, with spin; or moments [I1, I2, I3]") +
         more("about the axes as semi_axes names them, in m l^2, with spin") +
         line("finder", quoted(config.finder), "of contact times: \"certified\", or \"bracketing\" (the paper's)") +
         line("eps_d", toml_real(config.eps_d), "in l, for \"bracketing\": shallower contacts may be missed") +
         line("distance", quoted(config.distance), "for \"bracketing\": \"dual\", \"newton8\" or \"newton5\"") +
         line("neighbours", quoted(config.neighbours),
              "lists: \"auto\", \"dilated\", \"obp\" (the paper's) or \"cells\"");
}

std::string times_text(const Config& config) {
  return "\n[equilibration]\n" +
         line("time", time(config.equilibration_time),
              "in l sqrt(m/kT); \"auto\": until C2 < 0.05 and MSD > 1 l^2, at") +
         more("most 500") + "\n[production]\n" +
         line("time", time(config.production_time), "in l sqrt(m/kT); \"auto\": 30 times the equilibration, from 30") +
         more("to 5000");
}

std::string output_text(const Config& config) {
  return "\n[output]\n" +
         line("events", fmt::format("{}", config.events), "so many collisions of production go to events.csv") +
         line("trajectory", "[]", "none yet") +
         line("checkpoint_every", quoted(config.checkpoint_every),
              "of checkpoint.bin: a number and s, m or h; it is also written at") +
         more("the end, and when the run is stopped");
}

}  // namespace

std::string config_text(const Config& config, const std::string& header) {
  return header + kUnits + "\n" +
         line("seed", fmt::format("{}", config.seed), "of the random start: an integer, at least 0") + "\n[system]\n" +
         line("number", fmt::format("{}", config.number), "of bodies, in a periodic cubic box") +
         line("packing_fraction", toml_real(config.packing_fraction), "volume of the bodies / volume of the box") +
         shape_text(config) + dynamics_text(config) + times_text(config) + output_text(config);
}

std::string template_text() {
  Config config;
  config.packing_fraction = 0.4;
  config.aspect_ratio = 3;
  config.neighbours = "auto";
  return config_text(config,
                     "# hardbody: a run of hard ellipsoids. Start it with: hardbody run THIS_FILE\n"
                     "# Only packing_fraction and the shape are needed; the other values are the defaults.\n");
}

std::string resolved_text(const Config& config) {
  return config_text(config,
                     fmt::format("# hardbody {}: the configuration of this run, defaults filled in.\n", version()));
}

}  // namespace hardbody
