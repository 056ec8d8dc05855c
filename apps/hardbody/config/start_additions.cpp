#include "config/start_additions.h"

#include "base/errors.h"
#include "base/shapes.h"
#include "base/suggest.h"
#include "config/keys.h"
#include "config/rules.h"
#include "config/shape_forms.h"
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

/// Species of a file that the config is given the sections of; bodies of more sizes than that are one species.
constexpr std::size_t kMostSpecies = 64;

std::string inertia_line(const Frame& frame, const FrameBody& body) {
  const ed::Species* exact = frame.exact ? &frame.exact->species[body.type] : nullptr;
  if (exact != nullptr && !exact->spins) return "inertia = \"paper\"\n";
  if (!(body.inertia.minCoeff() > 0)) return "";
  return fmt::format("inertia = {}\n", value_text(body.inertia));
}

/// Returns a section for bodies that are all alike, without an inertia where the config has one for all.
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
  const ShapeNumbers numbers = numbers_of(*shape);
  const std::string text =
      fmt::format("\n[[species]]\nnumber = {}\nmass = {}\nkind = \"{}\"\n{}", bodies.size(), toml_real(first.mass),
                  to_string(numbers.kind), form_of(numbers.kind).toml(numbers));
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
  return std::any_of(document.entries.begin(), document.entries.end(),
                     [](const Entry& e) { return e.key == kNumberKey || without_index(e.key) == "species.number"; });
}

/// Returns the volume of the bodies whose shapes the frame says over that of the box. Where the config says the shapes,
/// it is put right when the state is there.
double packing_of(const Frame& frame, const TomlDocument& document, const std::string& file) {
  // The polyhedra that files have of superellipsoids are smaller than these.
  const bool inscribed = std::any_of(document.entries.begin(), document.entries.end(), [](const Entry& e) {
    return last_part(e.key) == "kind" && e.value.text == to_string(ShapeKind::superellipsoid);
  });
  const auto unknown = [inscribed](const FrameType& type) {
    return !type.shape || (inscribed && std::holds_alternative<geom::ConvexPolyhedron>(*type.shape));
  };
  double volume = 0;
  for (const FrameBody& body : frame.bodies) {
    const FrameType& type = frame.types[body.type];
    volume += unknown(type) ? 0 : ed::volume(*type.shape);
  }
  if (volume == 0) {
    throw InputError(fmt::format("{}: {} is missing, and {} has no shapes to compute it from; accepted: a number",
                                 document.where_of("system"), kPackingKey, file));
  }
  return volume / std::pow(box_of(frame, file), 3);
}

}  // namespace

StartFrame read_start_frame(const StartFile& start) {
  const std::unique_ptr<TrajectoryReader> source = open_frames(start.file);
  const TrajectoryReader& reader = *source;
  const std::uint64_t count = reader.frame_count();
  if (count == 0) throw InputError(fmt::format("{}: has no complete frame; accepted: a file with frames", start.file));
  const std::uint64_t last = last_frame(reader).value_or(count - 1);
  const std::uint64_t k = start.frame ? static_cast<std::uint64_t>(*start.frame) : last;
  if (k >= count) {
    throw InputError(fmt::format("{} is {}, {} has {} complete frames; accepted: 0 to {}", kStartFrameKey, k,
                                 start.file, count, count - 1));
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

TomlDocument completed(TomlDocument document, const StartFile& start, std::optional<StartFrame>& frame) {
  const bool shapes = has_section(document, "shape") || has_section(document, "species");
  const bool packing = document.find(kPackingKey) != nullptr;
  const bool numbers = has_numbers(document);
  if (shapes && packing && numbers && start.frame) return document;
  frame = read_start_frame(start);
  std::string text;
  std::vector<std::string> values;
  if (!shapes) text = species_text(frame->frame, start.file, document.find(kInertiaKey) == nullptr);
  if (shapes && !numbers) values.push_back(fmt::format("{}={}", kNumberKey, frame->frame.bodies.size()));
  if (!packing) {
    values.push_back(fmt::format("{}={}", kPackingKey, toml_real(packing_of(frame->frame, document, start.file))));
  }
  TomlDocument added = read_toml(text, start.file, values);
  for (Section& section : added.sections) {
    section.where = start.file;
    document.sections.push_back(std::move(section));
  }
  for (Entry& entry : added.entries) {
    entry.where = start.file;
    document.set(std::move(entry));
  }
  return document;
}

}  // namespace hardbody
