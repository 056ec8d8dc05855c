#include "scene/arguments.h"

#include "base/arguments.h"
#include "base/arrays.h"
#include "base/values.h"
#include "geometry/shapes.h"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace hardbody::python {
namespace {

/// Largest number of handles.
constexpr std::size_t kMostHandles = std::size_t{1} << 32;

}  // namespace

geom::SceneShape scene_shape(const ed::BodyShape& shape) {
  return std::visit([](const auto& s) { return geom::SceneShape(s); }, geom_shape(shape));
}

const geom::Pose& checked_pose(nb::handle value) {
  return instance<geom::Pose>(value, "pose");
}

geom::BodyId handle_of(nb::handle value, const char* name) {
  return static_cast<geom::BodyId>(integer(value, name, 0, static_cast<long long>(kMostHandles) - 1));
}

std::vector<geom::BodyId> handles_of(nb::handle value) {
  const IndexRows rows(value, "bodies", 1);
  std::vector<geom::BodyId> bodies;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    bodies.push_back(static_cast<geom::BodyId>(rows.at(k, 0, kMostHandles, "handles")));
  }
  return bodies;
}

geom::Filter filter_of(nb::handle group, nb::handle meets) {
  constexpr long long kMost = 0xffffffffLL;
  return {.group = static_cast<std::uint32_t>(integer(group, "group", 0, kMost)),
          .meets = static_cast<std::uint32_t>(integer(meets, "meets", 0, kMost))};
}

geom::Lattice lattice_of(nb::handle value) {
  geom::Lattice lattice;
  if (value.is_none()) return lattice;
  const bool is_number = !attribute(value, "__float__").is_none() && attribute(value, "__len__").is_none();
  if (is_number || (has_attribute(value, "ndim") && nb::cast<int>(value.attr("ndim")) == 0)) {
    return geom::Lattice::cube(positive(value, "lattice"));
  }
  constexpr const char* kLattices = "the edge of a cube, or finite numbers of shape (3, 3)";
  const RealArray rows(value, "lattice", kLattices);
  if (rows.shape() != std::vector<std::size_t>{3, 3}) refuse_shape("lattice", rows.shape(), kLattices);
  for (std::size_t k = 0; k < 3; ++k) {
    lattice.vectors[k] = Eigen::Vector3d::Map(rows.data() + 3 * k);
    if (!lattice.vectors[k].allFinite()) refuse_value(entry("lattice", k), shown(lattice.vectors[k]), "finite numbers");
  }
  return lattice;
}

double margin_of(nb::handle value) {
  const double margin = number(value, "margin");
  if (!(margin >= 0) || !std::isfinite(margin)) refuse_value("margin", shown(margin), "a finite length of 0 or more");
  return margin;
}

double reach(nb::handle value, const char* name) {
  const double length = number(value, name);
  if (!(length >= 0)) refuse_value(name, shown(length), "a number of 0 or more, or inf");
  return length;
}

}  // namespace hardbody::python
