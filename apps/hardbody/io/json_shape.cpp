#include "io/json_shape.h"

#include <geom/polyhedron.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr const char* kLength = "a positive number";
constexpr const char* kRounding = "a number of at least 0";

/// Reads a positive number that the library checks, too.
double length(const JsonMember& shape, const char* key) {
  return shape.at(key, kLength).number();
}

double rounding(const JsonMember& shape) {
  if (!shape.has("rounding")) return 0;
  const JsonMember member = shape.at("rounding", kRounding);
  if (!(member.number() >= 0)) throw member.bad(kRounding);
  return member.number();
}

/// Returns the shape, or the rounded one.
template <class Sharp>
geom::Shape rounded(Sharp sharp, const JsonMember& shape) {
  const double radius = rounding(shape);
  if (radius == 0) return sharp;
  return shape.at("rounding", kRounding).checked([&] { return geom::Rounded<Sharp>(std::move(sharp), radius); });
}

geom::Shape read_sphere(const JsonMember& shape) {
  const JsonMember radius = shape.at("radius", kLength);
  return radius.checked([&] { return geom::Sphere(radius.number()); });
}

geom::Shape read_capsule(const JsonMember& shape) {
  const double half_length = shape.at("half_length", kRounding).number();
  const double radius = length(shape, "radius");
  return shape.checked([&] { return geom::Capsule(half_length, radius); });
}

geom::Shape read_box(const JsonMember& shape) {
  const JsonMember half_extents = shape.at("half_extents", "three positive numbers");
  return rounded(half_extents.checked([&] { return geom::Box(half_extents.vector()); }), shape);
}

std::vector<Vector3d> read_vertices(const JsonMember& vertices) {
  constexpr const char* kAccepted = "a list of four points [x, y, z] or more";
  if (!vertices.json->is_array() || vertices.json->size() < 4) throw vertices.bad(kAccepted);
  std::vector<Vector3d> points;
  for (std::size_t k = 0; k < vertices.json->size(); ++k) {
    points.push_back(JsonMember{&vertices.json->at(k), fmt::format("{}[{}]", vertices.name, k)}.vector());
  }
  return points;
}

std::vector<Vector3d> read_solid(const JsonMember& shape) {
  const JsonMember solid = shape.at("solid", "");
  const std::string name = solid.text(fmt::format("{}", fmt::join(geom::solid_names(), ", ")));
  std::vector<Vector3d> points = solid.checked([&] { return geom::solid_vertices(name); });
  if (!shape.has("circumradius")) return points;
  const JsonMember circumradius = shape.at("circumradius", kLength);
  if (!(circumradius.number() > 0)) throw circumradius.bad(kLength);
  for (Vector3d& x : points) x *= circumradius.number();
  return points;
}

geom::Shape read_polyhedron(const JsonMember& shape) {
  if (shape.has("solid") == shape.has("vertices")) {
    throw shape.bad("a polyhedron with \"vertices\": [[x,y,z],..] or with \"solid\": \"cube\"");
  }
  const bool is_solid = shape.has("solid");
  if (!is_solid && shape.has("circumradius")) {
    throw shape.at("circumradius", "").bad("beside \"solid\" only");
  }
  const JsonMember source = shape.at(is_solid ? "solid" : "vertices", "");
  const std::vector<Vector3d> points = is_solid ? read_solid(shape) : read_vertices(source);
  return rounded(source.checked([&] { return geom::ConvexPolyhedron(points); }), shape);
}

geom::Shape read_cylinder(const JsonMember& shape) {
  const double half_length = length(shape, "half_length");
  const double radius = length(shape, "radius");
  return rounded(shape.checked([&] { return geom::Cylinder(half_length, radius); }), shape);
}

geom::Shape read_cone(const JsonMember& shape) {
  const double height = length(shape, "height");
  const double radius = length(shape, "radius");
  const double base = shape.has("base") ? shape.at("base", "a negative number").number() : -0.25 * height;
  return rounded(shape.checked([&] { return geom::Cone(height, radius, base); }), shape);
}

template <ShapeKind kind>
geom::Shape read_smooth(const JsonMember& shape) {
  return read_shape(shape, kind);
}

/// Kind of shape by its name in JSON, and the keys that it has.
struct JsonKind {
  std::string_view name;
  geom::Shape (*read)(const JsonMember& shape);
  std::array<std::string_view, 5> keys;
};

constexpr JsonKind kJsonKinds[] = {
    {"ellipsoid", read_smooth<ShapeKind::ellipsoid>, {"kind", "semi_axes"}},
    {"superellipsoid", read_smooth<ShapeKind::superellipsoid>, {"kind", "semi_axes", "exponents"}},
    {"sphere", read_sphere, {"kind", "radius"}},
    {"capsule", read_capsule, {"kind", "half_length", "radius"}},
    {"box", read_box, {"kind", "half_extents", "rounding"}},
    {"polyhedron", read_polyhedron, {"kind", "vertices", "solid", "circumradius", "rounding"}},
    {"cylinder", read_cylinder, {"kind", "half_length", "radius", "rounding"}},
    {"cone", read_cone, {"kind", "height", "radius", "base", "rounding"}},
};

std::string kind_names(const char* also) {
  std::string names;
  for (const JsonKind& kind : kJsonKinds) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", kind.name);
  return names + also;
}

Json to_json(const Vector3d& x) {
  return {x.x(), x.y(), x.z()};
}

Json json_of(const geom::Ellipsoid& s) {
  return {{"kind", "ellipsoid"}, {"semi_axes", to_json(s.semi_axes())}};
}
Json json_of(const geom::Superellipsoid& s) {
  return {{"kind", "superellipsoid"}, {"semi_axes", to_json(s.semi_axes())}, {"exponents", {s.e1(), s.e2()}}};
}
Json json_of(const geom::Sphere& s) {
  return {{"kind", "sphere"}, {"radius", s.radius()}};
}
Json json_of(const geom::Capsule& s) {
  return {{"kind", "capsule"}, {"half_length", s.half_length()}, {"radius", s.radius()}};
}
Json json_of(const geom::Box& s) {
  return {{"kind", "box"}, {"half_extents", to_json(s.half_extents())}};
}
Json json_of(const geom::ConvexPolyhedron& s) {
  Json vertices = Json::array();
  for (int k = 0; k < s.vertex_count(); ++k) vertices.push_back(to_json(s.vertex(k)));
  return {{"kind", "polyhedron"}, {"vertices", std::move(vertices)}};
}
Json json_of(const geom::Cylinder& s) {
  return {{"kind", "cylinder"}, {"half_length", s.half_length()}, {"radius", s.radius()}};
}
Json json_of(const geom::Cone& s) {
  return {{"kind", "cone"}, {"height", s.height()}, {"radius", s.radius()}, {"base", s.base()}};
}
template <class Inner>
Json json_of(const geom::Rounded<Inner>& s) {
  Json json = json_of(s.inner());
  json["rounding"] = s.radius();
  return json;
}
Json json_of(const ed::CustomShape& /*shape*/) {
  throw std::logic_error("a user's own shape in a file");
}

}  // namespace

geom::Shape read_shape(const JsonMember& shape, ShapeKind kind) {
  const JsonMember axes = shape.at("semi_axes", "three positive numbers");
  ShapeNumbers numbers{kind, axes.vector()};
  if (!has_exponents(kind)) return axes.checked([&] { return make_shape(numbers); });
  const JsonMember exponents = shape.at("exponents", "two numbers [e1, e2]");
  const std::vector<double> e = exponents.numbers(2, "two numbers [e1, e2]");
  // The axes are checked first, so that the right member is named if the library refuses them.
  axes.checked([&] { return make_shape(numbers); });
  numbers.exponents = {e[0], e[1]};
  return exponents.checked([&] { return make_shape(numbers); });
}

geom::Shape read_shape(const JsonMember& shape, const char* also) {
  if (!shape.json->is_object()) throw shape.bad("{\"kind\":\"ellipsoid\",\"semi_axes\":[a,b,c]}");
  if (!shape.has("kind")) (void)shape.at("kind", kind_names(also));  // says what is accepted
  const JsonMember kind = shape.at("kind", "");
  const auto* found = std::find_if(std::begin(kJsonKinds), std::end(kJsonKinds), [&](const JsonKind& known) {
    return kind.json->is_string() && kind.json->get_ref<const std::string&>() == known.name;
  });
  if (found == std::end(kJsonKinds)) throw kind.bad(kind_names(also));
  const auto* const keys_end = std::find(found->keys.begin(), found->keys.end(), std::string_view());
  shape.allow(std::span(found->keys.begin(), keys_end));
  return found->read(shape);
}

bool is_half_space(const JsonMember& shape) {
  return shape.has("kind") && *shape.at("kind", "").json == "half_space";
}

geom::HalfSpace read_half_space(const JsonMember& shape) {
  constexpr std::array<std::string_view, 3> kKeys = {"kind", "normal", "offset"};
  shape.allow(kKeys);
  const Vector3d normal = shape.has("normal") ? shape.at("normal", "").vector() : Vector3d::UnitZ();
  const double offset = shape.has("offset") ? shape.at("offset", "").number() : 0;
  return shape.checked([&] { return geom::HalfSpace(normal, offset); });
}

Json shape_json(const ed::BodyShape& shape) {
  return std::visit([](const auto& s) { return json_of(s); }, shape);
}

}  // namespace hardbody
