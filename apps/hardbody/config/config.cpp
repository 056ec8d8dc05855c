#include "config/config.h"

#include "base/number_text.h"
#include "config/box.h"
#include "config/keys.h"
#include "config/species.h"
#include "config/start_additions.h"
#include "io/text_file.h"
#include "io/toml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hardbody {
namespace {

constexpr std::size_t kLongestConfig = 1 << 20;  ///< bytes
constexpr double kUsualCap = 500;                ///< default cap of equilibration, in ed::time_unit of the bodies
constexpr double kUsualEpsD = 1e-6;              ///< default of eps_d, in mean_length() of the bodies

/// Refuses keys that have no meaning beside `other`.
void refuse_beside(const TomlDocument& document, const char* other, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const Entry* entry = document.find(name);
    if (entry != nullptr) throw bad(*entry, fmt::format("no key {} beside {}", name, other));
  }
}

void read_start_file(const TomlDocument& document, Config& config) {
  if (document.find(kStartFileKey) == nullptr) {
    for (const Entry& entry : document.entries) {
      if (section_of(entry.key) == "start") throw bad(entry, "start.file beside it");
    }
    return;
  }
  config.start_file.emplace();
  read_key(document, kStartFileKey, {config});
  refuse_beside(document, kStartFileKey, {kStartKey, kStartFromKey, kOrderKey});
  read_section(document, "start", {config});
  config.start_file->file = absolute_path(config.start_file->file).string();
}

void read_start(const TomlDocument& document, Config& config) {
  read_key(document, kStartFromKey, {config});
  read_key(document, kStartKey, {config});
  read_key(document, kOrderKey, {config});
  if (config.start_from && config.start) refuse_beside(document, "start_from", {kStartKey});
  if (config.start_from) refuse_beside(document, "start_from", {kOrderKey});
}

/// Refuses logarithmic times in a format whose frames have numbers and no times: readers take these for evenly spaced.
void check_spacing(const TomlDocument& document, const Config& config) {
  const auto& formats = config.trajectory;
  const bool dumps = std::find(formats.begin(), formats.end(), TrajectoryFormat::lammps) != formats.end();
  if (config.frames_spacing == FramesSpacing::even || !dumps) return;
  throw bad(*document.find(kSpacingKey),
            "\"even\" with trajectory = [\"lammps\"], whose frames have no times; or \"gsd\"");
}

/// Refuses frames at an interval that production has more of than there is room for.
void check_frames(const TomlDocument& document, const Config& config) {
  if (!config.frames_every || !config.production_time || config.trajectory.empty()) return;
  const double wanted = std::floor(*config.production_time / *config.frames_every * (1 + 1e-12)) + 1;
  if (wanted <= static_cast<double>(config.frames)) return;
  const char* key = document.find(kFramesKey) != nullptr ? kFramesKey : kEveryKey;
  throw bad(*document.find(key),
            fmt::format("frames = {:.0f} at least, with frames_every = {} and production.time = {}", wanted,
                        *config.frames_every, *config.production_time));
}

/// Returns the radius of the sphere of the bodies' volume: the mean, as a power of two.
double mean_length(std::vector<ed::Component> components) {
  for (ed::Component& component : components) component.species.mass = 1;
  return ed::time_unit(components);
}

/// Refuses the paper's finder for shapes without equations.
void check_finder(const TomlDocument& document, const Config& config) {
  if (config.finder == ed::Finder::certified) return;
  for (const SpeciesConfig& species : config.species) {
    if (geom::has_equations(geom_shape(species.body.shape))) continue;
    throw bad(*document.find(kFinderKey), "\"certified\"",
              fmt::format(", which solves equations that {} have not", plural(species.shape.kind)));
  }
}

void read_dynamics(const TomlDocument& document, Config& config) {
  config.eps_d = kUsualEpsD * mean_length(config.components());
  read_section(document, "dynamics", {config});
  if (config.finder == ed::Finder::certified && config.distance != ed::DistanceMethod::dual) {
    throw bad(*document.find(kDistanceKey), "\"dual\" with finder = \"certified\"; others with \"bracketing\"");
  }
  check_finder(document, config);
  config.neighbours_chosen = !config.neighbours;
}

void read_packing(const TomlDocument& document, Config& config) {
  if (document.find(kPackingKey) == nullptr) throw missing(document.where_of("system"), kPackingKey, {config});
  read_key(document, kPackingKey, {config});
}

/// Chooses for neighbours = "auto". Only ellipsoids of revolution have been measured; for others, and for bodies of
/// several sizes, dilated bodies are what costs little at any density.
void choose_neighbours(Config& config) {
  const ed::BodyShape& shape = config.species[0].body.shape;
  const bool measured = !config.mixture && ed::is_spheroid(shape) && config.all_of_revolution();
  const bool cells = measured && ed::fastest_neighbours(shape, config.number, config.packing_fraction, config.finder) ==
                                     ed::Neighbours::cells;
  config.neighbours = cells ? ed::Neighbours::cells : ed::Neighbours::dilated;
}

}  // namespace

const char* to_string(Inertia inertia) {
  return std::array{"paper", "uniform", "moments"}[static_cast<std::size_t>(inertia)];
}

const char* to_string(TrajectoryFormat format) {
  return std::array{"gsd", "lammps", "vtk"}[static_cast<std::size_t>(format)];
}

const char* to_string(BondOrder order) {
  return std::array{"steinhardt", "hexatic"}[static_cast<std::size_t>(order)];
}

const char* to_string(FramesSpacing spacing) {
  return std::array{"even", "log"}[static_cast<std::size_t>(spacing)];
}

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
  for (const SpeciesConfig& s : species) list.push_back({s.number, s.rotation_axes(), !is_sphere(s)});
  return list;
}

ed::BondOptions Config::bonds() const {
  const auto asked = [this](BondOrder one) { return std::find(order.begin(), order.end(), one) != order.end(); };
  return {asked(BondOrder::steinhardt), order_neighbours, asked(BondOrder::hexatic)};
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
  return neighbours.value_or(ed::Neighbours::dilated);
}

bool is_sphere(const SpeciesConfig& species) {
  return ed::is_sphere(species.body.shape);
}

ed::SimulationOptions Config::simulation_options(double envelope) const {
  ed::SimulationOptions options;
  options.envelope = envelope;
  options.neighbours = neighbour_search();
  options.contact.finder = finder;
  options.contact.distance = distance;
  options.contact.eps_d = eps_d;
  return options;
}

std::optional<ed::LatticeOptions> Config::lattice() const {
  if (!start) return std::nullopt;
  ed::LatticeOptions options;
  options.lattice = *start;
  options.packing_fraction = packing_fraction;
  options.seed = static_cast<std::uint64_t>(seed);
  options.nematic_order = nematic_order;
  options.groups = numbers();
  return options;
}

double Config::checkpoint_seconds() const {
  return duration_seconds(checkpoint_every).value_or(std::numeric_limits<double>::infinity());
}

Config read_config(const TomlDocument& given, std::optional<StartFrame>* loaded) {
  check_names(given);
  Config config;
  read_start_file(given, config);
  std::optional<StartFrame> frame;
  const TomlDocument document = config.start_file ? completed(given, *config.start_file, frame) : given;
  if (frame) config.start_file->frame = static_cast<std::int64_t>(frame->number);
  if (loaded != nullptr) *loaded = std::move(frame);
  read_section(document, "", {config});
  read_species(document, config);
  config.time_unit = ed::time_unit(config.components());
  config.equilibration_cap = kUsualCap * config.time_unit;
  for (const char* section : {"equilibration", "production", "output"}) read_section(document, section, {config});
  check_spacing(document, config);
  check_frames(document, config);
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

Config load_config(const std::string& path, const std::vector<std::string>& overrides,
                   std::optional<StartFrame>* frame) {
  return read_config(read_toml(read_file(path, kLongestConfig), path, overrides), frame);
}

}  // namespace hardbody
