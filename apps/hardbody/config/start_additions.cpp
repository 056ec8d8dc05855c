#include "config/start_additions.h"

#include "base/errors.h"
#include "config/values.h"
#include "io/text_file.h"
#include "trajectory/reader.h"

#include <ed/shape.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// Species of a file that the config is given the sections of; bodies of more sizes than that are one species.
constexpr std::size_t kMostSpecies = 64;
std::string three(const Vector3d& v) {
  return fmt::format("[{}, {}, {}]", toml_real(v.x()), toml_real(v.y()), toml_real(v.z()));
}

std::string inertia_line(const Frame& frame, const FrameBody& body) {
  const ed::Species* exact = frame.exact ? &frame.exact->species[body.type] : nullptr;
  if (exact != nullptr && !exact->spins) return "inertia = \"paper\"\n";
  if (!(body.inertia.minCoeff() > 0)) return "";
  return fmt::format("inertia = {}\n", three(body.inertia));
}

/// A section for bodies that are all alike, without an inertia where the config has one for all.
std::string species_section(const Frame& frame, const std::vector<std::size_t>& bodies, const std::string& file,
                            bool with_inertia) {
  const FrameBody& first = frame.bodies[bodies.front()];
  const std::string& type = frame.types[first.type].name;
  const std::optional<ed::BodyShape>& shape = frame.types[first.type].shape;
  if (!shape) {
    throw InputError(
        fmt::format("{}: has no shape of type {} that can move here; accepted: [shape] or [[species]] in "
                    "the config",
                    file, one_line(type, 40)));
  }
  const auto alike = [&](std::size_t i) {
    const FrameBody& b = frame.bodies[i];
    return b.type == first.type && b.mass == first.mass && b.inertia == first.inertia;
  };
  if (!std::all_of(bodies.begin(), bodies.end(), alike)) {
    throw InputError(
        fmt::format("{}: its bodies of type {} are of different sizes; accepted: [[species]] with sizes, "
                    "width and size_seed in the config",
                    file, one_line(type, 40)));
  }
  const auto* barr = std::get_if<geom::Superellipsoid>(&*shape);
  std::string text = fmt::format("\n[[species]]\nnumber = {}\nmass = {}\nsemi_axes = {}\n", bodies.size(),
                                 toml_real(first.mass), three(ed::half_extents(*shape)));
  if (barr != nullptr) {
    text +=
        fmt::format("kind = \"superellipsoid\"\nexponents = [{}, {}]\n", toml_real(barr->e1()), toml_real(barr->e2()));
  }
  return with_inertia ? text + inertia_line(frame, first) : text;
}

std::string species_text(const Frame& frame, const std::string& file, bool with_inertia) {
  const std::vector<std::vector<std::size_t>> groups = groups_of(frame);
  if (groups.size() > kMostSpecies) {
    throw InputError(fmt::format("{}: has {} types of bodies; accepted: at most {}, or [[species]] in the config", file,
                                 groups.size(), kMostSpecies));
  }
  std::string text;
  for (const std::vector<std::size_t>& group : groups) text += species_section(frame, group, file, with_inertia);
  return text;
}

bool has_section(const TomlDocument& document, std::string_view prefix) {
  const auto of_it = [&](const auto& name) { return name.starts_with(prefix); };
  return std::any_of(document.sections.begin(), document.sections.end(),
                     [&](const Section& s) { return of_it(s.name); }) ||
         std::any_of(document.entries.begin(), document.entries.end(), [&](const Entry& e) { return of_it(e.key); });
}

bool has_numbers(const TomlDocument& document) {
  return std::any_of(document.entries.begin(), document.entries.end(), [](const Entry& e) {
    return e.key == "system.number" || (e.key.starts_with("species[") && e.key.ends_with("].number"));
  });
}

bool flag(const TomlDocument& document, const char* key) {
  const Entry* entry = document.find(key);
  if (entry == nullptr) return false;
  if (entry->value.kind != Value::Kind::boolean) throw bad(*entry, "true or false");
  return entry->value.integer == 1;
}

}  // namespace

StartFrame read_start_frame(const StartFile& start) {
  const std::unique_ptr<TrajectoryReader> source = open_frames(start.file);
  const TrajectoryReader& reader = *source;
  const std::uint64_t count = reader.frame_count();
  if (count == 0) throw InputError(fmt::format("{}: has no whole frame; accepted: a file with frames", start.file));
  const std::uint64_t last = last_frame(reader).value_or(count - 1);
  const std::uint64_t k = start.frame ? static_cast<std::uint64_t>(*start.frame) : last;
  if (k >= count) {
    throw InputError(
        fmt::format("start.frame is {}, {} has {} whole frames; accepted: 0 to {}", k, start.file, count, count - 1));
  }
  return {reader.read(k), k, reader.cut_off()};
}

double box_of(const Frame& frame, const std::string& file) {
  if (frame.exact) return frame.exact->box;
  if (const std::optional<std::string> why = not_a_cube(frame)) {
    throw InputError(fmt::format("{}: {}; accepted: a cube", file, *why));
  }
  return frame.box.x();
}

std::vector<std::vector<std::size_t>> groups_of(const Frame& frame) {
  std::map<std::uint32_t, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) groups[frame.bodies[i].group].push_back(i);
  std::vector<std::vector<std::size_t>> list;
  list.reserve(groups.size());
  for (auto& [number, bodies] : groups) list.push_back(std::move(bodies));
  return list;
}

std::optional<StartFile> read_start_file(const TomlDocument& document) {
  const Entry* file = document.find("start.file");
  for (const char* key : {"start.frame", "start.mend", "start.reverse"}) {
    const Entry* entry = document.find(key);
    if (entry != nullptr && file == nullptr) throw bad(*entry, "start.file beside it");
  }
  if (file == nullptr) return std::nullopt;
  if (file->value.kind != Value::Kind::text || file->value.text.empty()) throw bad(*file, "the name of a file");
  for (const char* key : {"system.start", "system.start_from", "system.nematic_order"}) {
    if (const Entry* entry = document.find(key)) throw bad(*entry, "no such key beside start.file");
  }
  StartFile start;
  start.file = absolute_path(file->value.text).string();
  if (const Entry* frame = document.find("start.frame")) {
    if (frame->value.kind != Value::Kind::integer || frame->value.integer < 0)
      throw bad(*frame, "an integer, at least 0");
    start.frame = frame->value.integer;
  }
  start.mend = flag(document, "start.mend");
  start.reverse = flag(document, "start.reverse");
  return start;
}

StartAdditions additions_from(const StartFile& start, const TomlDocument& document) {
  const bool shapes = has_section(document, "shape") || has_section(document, "species");
  const bool packing = document.find("system.packing_fraction") != nullptr;
  StartAdditions additions;
  if (shapes && packing && has_numbers(document) && start.frame) return additions;
  const auto [frame, k, cut_off] = read_start_frame(start);
  if (!start.frame) additions.overrides.push_back(fmt::format("start.frame={}", k));
  if (!shapes) {
    additions.text = species_text(frame, start.file, document.find("dynamics.inertia") == nullptr);
  }
  if (shapes && !has_numbers(document)) {
    additions.overrides.push_back(fmt::format("system.number={}", frame.bodies.size()));
  }
  if (packing) return additions;
  // Only the bodies' own volume is missing, which the config may say: it is put right when the state is there.
  double volume = 0;
  for (const FrameBody& body : frame.bodies) {
    const std::optional<ed::BodyShape>& shape = frame.types[body.type].shape;
    volume += shape ? ed::volume(*shape) : 0;
  }
  if (volume == 0) {
    throw InputError(fmt::format("{}: system.packing_fraction is missing, and {} says no shapes; accepted: a number",
                                 document.where_of("system"), start.file));
  }
  additions.overrides.push_back(
      fmt::format("system.packing_fraction={}", toml_real(volume / std::pow(box_of(frame, start.file), 3))));
  return additions;
}

}  // namespace hardbody
