#include "config/text.h"

#include "base/find.h"
#include "base/suggest.h"
#include "base/version.h"
#include "config/keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace hardbody {
namespace {

constexpr const char* kUnits =
    "# Units: kT = m = 1 and length l = (a b c)^(1/3) = 1, a, b, c the semi-axes; time in l sqrt(m/kT).\n"
    "# In these units a sphere has radius 1.\n";
constexpr const char* kVolumeUnits =
    "# Units: kT = m = 1 and length l = 1, the radius of the sphere of the body's volume; time in l sqrt(m/kT).\n";
constexpr const char* kMixtureUnits =
    "# Units: kT = 1; lengths and masses as the species give them: l and m are those units; time in l sqrt(m/kT).\n";

/// Returns the line of a key with its comment; further lines of the comment stand below it.
std::string key_lines(const PlacedKey& key) {
  const std::string value = key.key->rule.text(key.place);
  std::string comment = value.empty() ? key.key->without : key.key->comment.at(key.place);
  std::string text;
  if (!value.empty()) text = fmt::format("{:<31} ", fmt::format("{} = {}", last_part(key.name), value));
  while (!comment.empty()) {
    const std::size_t end = std::min(comment.find('\n'), comment.size());
    text += fmt::format("{}# {}\n", text.empty() || text.back() == '\n' ? std::string(32, ' ') : "",
                        comment.substr(0, end));
    comment.erase(0, end + 1);
  }
  return text;
}

std::string head_of(std::string_view section) {
  const bool several = section != without_index(section);
  return several ? fmt::format("\n[[{}]]\n", section.substr(0, section.find('['))) : fmt::format("\n[{}]\n", section);
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
    {"capsule", "hard capsules (spherocylinders), twice as long between the caps as thick",
     "[system]\npacking_fraction = 0.3\n[shape]\nkind = \"capsule\"\nlength = 2\ndiameter = 1\n"},
    {"polyhedron", "hard dodecahedra, or other polyhedra",
     "[system]\npacking_fraction = 0.3\n[shape]\nkind = \"polyhedron\"\nsolid = \"dodecahedron\"\n"},
    {"mixture", "a mixture: rods, and spheres of several sizes",
     "[system]\npacking_fraction = 0.3\n"
     "[[species]]\nsemi_axes = [0.5, 0.5, 1.5]\nfraction = 0.75\n"
     "[[species]]\nsemi_axes = [0.8, 0.8, 0.8]\nfraction = 0.25\nsizes = \"gaussian\"\nwidth = 0.1\n"},
};

}  // namespace

std::string config_text(const Config& config, const std::string& header) {
  const bool axes = has_semi_axes(config.species[0].shape.kind);
  std::string text = header + (config.mixture ? kMixtureUnits : axes ? kUnits : kVolumeUnits) + "\n";
  std::string section;
  for (const PlacedKey& key : keys_of(config)) {
    const std::string_view now = section_of(key.name);
    if (now != section) text += head_of(now);
    text += key_lines(key);
    section = now;
  }
  return text;
}

namespace {

/// Returns a run's config with a grid at its end.
std::string sweep_template() {
  Config config = parse_config(kTemplates[0].config, "template");
  config.neighbours.reset();
  return config_text(
             config,
             "# hardbody: a sweep, a run at every point of a grid. Start it, or go on with it, with: hardbody sweep "
             "THIS_FILE\n"
             "# The config is that of hardbody run; the keys in [grid], at the end, take each of their values "
             "instead.\n"
             "# base = \"run.toml\", instead of all that is not in [grid], takes it from that file.\n"
             "# chain = \"system.packing_fraction\": denser points start from the last state of the one before.\n"
             "# replicas = 8: every point eight times, with other seeds; the table has their means.\n") +
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
  const Template* found = find_by(kTemplates, &Template::name, name);
  if (found == nullptr) return std::nullopt;
  Config config = parse_config(found->config, "template");
  config.neighbours.reset();
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
