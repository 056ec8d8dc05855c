#include "base/arguments.h"
#include "base/unlocked.h"
#include "simulation/bind.h"
#include "simulation/paths.h"
#include "simulation/species.h"
#include "simulation/systems.h"

#include <base/errors.h>
#include <config/config.h>
#include <config/start_additions.h>
#include <io/toml_document.h>
#include <start/from_file.h>
#include <trajectory/reader.h>

#include <ed/system.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hardbody::python {
namespace {

constexpr const char* kConfigName = "from_gsd";

/// Returns the number of a frame that is counted from the end if negative; -1 stands for the last one with positions.
std::optional<std::int64_t> frame_number(nb::handle frame, const std::string& file) {
  const long long k =
      integer(frame, "frame", std::numeric_limits<std::int64_t>::min() + 1, std::numeric_limits<std::int64_t>::max());
  if (k == -1) return std::nullopt;
  const auto count = static_cast<std::int64_t>(open_frames(file)->frame_count());
  if (count > 0 && (k < -count || k >= count)) {
    refuse_value("frame", std::to_string(k),
                 "-" + std::to_string(count) + " to " + std::to_string(count - 1) + " in " + file);
  }
  if (count == 0) return 0;  // reading it tells that the file has none
  return k < 0 ? count + k : k;
}

/// Returns the program's config of a start from this file that leaves everything else to the file.
Config config_of(const StartFile& start, std::int64_t seed, std::optional<StartFrame>& frame) {
  std::string text = "seed = " + std::to_string(seed) + "\n[start]\nfile = " + toml_string(start.file) + '\n';
  if (start.frame) text += "frame = " + std::to_string(*start.frame) + '\n';
  if (start.mend) text += "mend = true\n";
  if (start.reverse) text += "reverse = true\n";
  return read_config(read_toml(text, kConfigName, {}), &frame);
}

/// Hands the program's remarks to Python: what the file does not say as warnings, the rest to the log.
void report(const FileStart& start) {
  for (const std::string& notice : start.notices) {
    if (PyErr_WarnEx(PyExc_UserWarning, notice.c_str(), 1) != 0) throw nb::python_error();
  }
  nb::module_::import_("logging").attr("getLogger")("hardbody").attr("info")("%s", start.report);
}

/// Returns the program's config of a start of these bodies from this file.
Config with_components(const StartFile& start, const std::vector<ComponentGroup>& groups, std::int64_t seed,
                       const Frame& frame) {
  Config config;
  config.seed = seed;
  config.start_file = start;
  config.mixture = true;
  double volume = 0;
  for (const ComponentGroup& g : groups) {
    if (std::holds_alternative<ed::CustomShape>(g.species.shape)) {
      throw nb::type_error("components: a shape of your own; accepted: built-in shapes, or System(...) with arrays");
    }
    SpeciesConfig& species = config.species.emplace_back();
    species.body = g.species;
    species.number = g.number;
    species.factors = g.factors;
  }
  for (const ed::Component& c : config.components()) volume += c.number * ed::volume(c.species.shape);
  config.packing_fraction = volume / std::pow(box_of(frame, start.file), 3);
  return config;
}

/// Returns a message of the program with Python's words for keys of a config.
std::string in_words_of_python(std::string message) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kWords = {{
      {"[[species]] with sizes, width and size_seed in the config", "components with a Polydisperse"},
      {"[shape] or [[species]] in the config", "components=[(species, number), ...]"},
      {"[[species]] in the config", "components=[(species, number), ...]"},
      {" bodies of its types, the config ", " bodies of its types, components have "},
      {"or no shape in the config", "or no components"},
      {", in the config ", ", in components "},
      {"start.mend = true", "mend=True"},
      {"start.frame", "frame"},
  }};
  for (const auto& [key, word] : kWords) {
    if (const std::size_t at = message.find(key); at != std::string::npos) message.replace(at, key.size(), word);
  }
  return message;
}

/// Returns bodies of one species in groups as those of the frame.
std::vector<ComponentGroup> in_groups_of(const Frame& frame, const ed::Species& species) {
  std::map<std::uint32_t, int> numbers;
  for (const FrameBody& body : frame.bodies) ++numbers[body.group];
  std::vector<ComponentGroup> groups;
  for (const auto& [group, number] : numbers) groups.push_back({species, number, {}});
  return groups;
}

std::vector<ComponentGroup> components_for(const Frame& frame, nb::handle components, std::uint64_t seed) {
  if (is_species(components)) return in_groups_of(frame, species_of(components, "components"));
  return components_of(components, nb::none(), seed);
}

FileStart read_start(const StartFile& start, nb::handle components, std::uint64_t seed, std::vector<int>& numbers) {
  const auto signed_seed = static_cast<std::int64_t>(seed);
  std::optional<StartFrame> loaded;
  Config config;
  if (components.is_none()) {
    config = config_of(start, signed_seed, loaded);
  } else {
    loaded = read_start_frame(start);
    config = with_components(start, components_for(loaded->frame, components, seed), signed_seed, loaded->frame);
  }
  numbers = config.numbers();
  return unlocked([&] { return start_from_file(config, std::move(loaded)); });
}

BodySystem from_gsd(nb::handle path, nb::handle frame, nb::handle components, nb::handle seed, nb::handle mend,
                    nb::handle reverse) {
  StartFile start;
  start.file = existing_path(path);
  start.frame = frame_number(frame, start.file);
  start.mend = truth(mend, "mend");
  start.reverse = truth(reverse, "reverse");
  std::vector<int> groups;
  try {
    FileStart made = read_start(start, components, seed_of(seed, "seed"), groups);
    report(made);
    return {std::move(made.system), std::move(groups)};
  } catch (const InputError& error) {
    throw std::invalid_argument(in_words_of_python(error.what()));
  }
}

}  // namespace

void bind_files(nb::module_& module) {
  module.def(
      "from_gsd", &from_gsd, nb::arg("path").none(), nb::arg("frame").none() = -1, nb::arg("components") = nb::none(),
      nb::kw_only(), nb::arg("seed").none() = 1, nb::arg("mend").none() = false, nb::arg("reverse").none() = false,
      nb::sig("def from_gsd(path: str | os.PathLike[str], frame: int = -1, "
              "components: hardbody.Components | None = None, *, seed: int = 1, mend: bool = False, "
              "reverse: bool = False) -> System"),
      "Returns a state from a trajectory: a GSD file of this or another program, or a LAMMPS text dump.\n"
      "\n"
      "frame: from 0; negative numbers count from the end, -1 is the last frame with positions. components: bodies in\n"
      "the order of the file's types, as for random_start, where the file does not give shapes, masses or moments, or\n"
      "others are wanted; a single species or shape is that of all bodies of the file, whose types are a group each;\n"
      "bodies with distributed sizes need their Polydisperse, with the seed of their run. mend: overlaps are removed "
      "by\n"
      "scaling box and positions; otherwise they are refused. reverse: all velocities are negated.\n"
      "\n"
      "Rules are those of [start] file (docs/configuration.md): states of this program are taken bit for bit; what a\n"
      "file does not contain is never guessed; velocities that it lacks are drawn with the seed, others are rescaled\n"
      "to kT = 1 unless the bodies are those of the file. What was done is reported to the logger 'hardbody'; remarks "
      "of\n"
      "the reader are warnings.\n"
      "\n"
      "Raises FileNotFoundError, ValueError for a file that is none or lacks what is needed, naming it.");
}

}  // namespace hardbody::python
