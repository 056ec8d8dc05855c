#include "trajectory/lammps/columns.h"

#include "io/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hardbody {
namespace {

/// Prefixes of columns that may contain orientations and shapes under names that the program does not use: of computes,
/// fixes, variables and custom properties, and in other programs.
constexpr std::array<std::string_view, 10> kUnnamed = {"c_",  "f_", "v_", "d_",     "d2_",
                                                       "i2_", "q",  "mu", "orient", "shape"};

/// Exponents of superellipsoids in the conventions of LIGGGHTS and of LAMMPS's own, with which shapex is another size.
constexpr std::array<std::string_view, 3> kExponents = {"blockiness", "roundness", "block"};

bool begins_as(std::string_view name, const auto& list) {
  return std::any_of(list.begin(), list.end(), [&](std::string_view begin) { return name.starts_with(begin); });
}

/// Lists names for a message.
std::string listed(const std::vector<std::string_view>& names) {
  return one_line(fmt::format("column{} {}", names.size() > 1 ? "s" : "", fmt::join(names, " ")), 120);
}

constexpr std::string_view kRename = "dump_modify colname, or editing the head of each frame, gives these names";

}  // namespace

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.empty()) return words;
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

DumpColumns::Column DumpColumns::find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? Column() : Column(static_cast<std::size_t>(found - names.begin()));
}

template <std::size_t n>
std::optional<std::array<std::size_t, n>> DumpColumns::all(const std::array<std::string_view, n>& wanted) const {
  std::array<std::size_t, n> result{};
  for (std::size_t k = 0; k < n; ++k) {
    const Column column = find(wanted[k]);
    if (!column) return std::nullopt;
    result[k] = *column;
  }
  return result;
}

DumpColumns::DumpColumns(std::vector<std::string_view> list) : names(std::move(list)) {
  for (std::size_t k = 0; k < 3; ++k) {
    const char letter = "xyz"[k];
    axes[k] = {find(fmt::format("{}", letter)), find(fmt::format("{}s", letter)), find(fmt::format("{}u", letter)),
               find(fmt::format("{}su", letter)), find(fmt::format("i{}", letter))};
  }
  id = find("id");
  type = find("type");
  mass = find("mass");
  radius = find("radius");
  diameter = find("diameter");
  quaternion = all<4>({"quatw", "quati", "quatj", "quatk"});
  velocity = all<3>({"vx", "vy", "vz"});
  angular_momentum = all<3>({"angmomx", "angmomy", "angmomz"});
  angular_velocity = all<3>({"omegax", "omegay", "omegaz"});
  diameters = all<3>({"shapex", "shapey", "shapez"});
  roundness = all<2>({"SuperquadricRoundness.Phi", "SuperquadricRoundness.Theta"});
  note_unused();
}

void DumpColumns::note_unused() {
  const auto named = [&](const auto& begins) {
    std::vector<std::string_view> found;
    std::copy_if(names.begin(), names.end(), std::back_inserter(found), begins);
    return found;
  };
  const auto exponents = named([](std::string_view name) { return begins_as(name, kExponents); });
  if (diameters && !exponents.empty()) {
    notices.push_back(
        fmt::format("shapex shapey shapez: not used together with {}, which have another convention; shapes are read "
                    "from diameters "
                    "shapex shapey shapez with exponents SuperquadricRoundness.Phi .Theta",
                    listed(exponents)));
    diameters.reset();
    radius.reset();  // the radius of a sphere around such a body
    diameter.reset();
  }
  const auto unnamed = named([](std::string_view name) {
    return begins_as(name, kUnnamed) && name != "quatw" && name != "quati" && name != "quatj" && name != "quatk" &&
           name != "shapex" && name != "shapey" && name != "shapez" && name != "q";
  });
  if ((!quaternion || !diameters) && !unnamed.empty()) {
    std::string text = listed(unnamed) + ": not used";
    if (!quaternion) text += "; orientations are read from quatw quati quatj quatk";
    if (!diameters) text += "; shapes from diameters shapex shapey shapez";
    notices.push_back(fmt::format("{}: {}", text, kRename));
  }
  if ((radius || diameter) && !diameters && quaternion) {
    notices.push_back(fmt::format(
        "column {}: not used, because bodies with orientations are not spheres; shapes are read from diameters "
        "shapex shapey shapez",
        radius ? "radius" : "diameter"));
    radius.reset();
    diameter.reset();
  }
  if (diameters) radius = diameter = Column();
  if (radius || diameter) {
    notices.push_back(
        fmt::format("column {}: bodies are treated as spheres of these sizes", radius ? "radius" : "diameter"));
  }
  if (!type && find("element")) {
    notices.emplace_back("column element: not used; types are read from type; without it all bodies have one type");
  }
}

bool DumpColumns::unwrapped() const {
  return std::all_of(axes.begin(), axes.end(), [](const Axis& axis) {
    return axis.unwrapped || axis.unwrapped_scaled || (axis.image && (axis.wrapped || axis.scaled));
  });
}

bool DumpColumns::unwrapped_columns() const {
  return std::all_of(axes.begin(), axes.end(),
                     [](const Axis& axis) { return axis.unwrapped || axis.unwrapped_scaled; });
}

}  // namespace hardbody
