#include "trajectory/gsd/type_shapes.h"

#include "base/errors.h"
#include "base/shapes.h"
#include "io/json_member.h"
#include "trajectory/frame.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// Number of types beyond which they are drawn coarsely: in a polydisperse system every body has a type of its own.
constexpr std::size_t kFineTypes = 64;

/// Returns |x|^e with the sign of x.
double signed_power(double x, double e) {
  return std::copysign(std::pow(std::abs(x), e), x);
}

/// Returns points of Barr's parametrisation, which are dense where the surface is strongly curved for exponents below
/// 1: both poles, and rings.
std::vector<Vector3d> surface_points(const ShapeNumbers& shape, int rings, int per_ring) {
  const Vector3d& a = shape.lengths;
  const double e1 = shape.exponents.x();
  const double e2 = shape.exponents.y();
  std::vector<Vector3d> points = {{0, 0, -a.z()}, {0, 0, a.z()}};
  for (int i = 1; i <= rings; ++i) {
    const double eta = std::numbers::pi * (static_cast<double>(i) / (rings + 1) - 0.5);
    const double across = signed_power(std::cos(eta), e1);
    for (int k = 0; k < per_ring; ++k) {
      const double omega = 2 * std::numbers::pi * k / per_ring;
      points.emplace_back(a.x() * across * signed_power(std::cos(omega), e2),
                          a.y() * across * signed_power(std::sin(omega), e2), a.z() * signed_power(std::sin(eta), e1));
    }
  }
  return points;
}

std::string polyhedron_json(const std::vector<Vector3d>& vertices, double rounding, bool fine) {
  std::string text;
  for (const Vector3d& p : vertices) {
    // Few types have room for all digits.
    text += fmt::format(fmt::runtime(fine ? "{}[{}, {}, {}]" : "{}[{:.7g}, {:.7g}, {:.7g}]"), text.empty() ? "" : ", ",
                        p.x(), p.y(), p.z());
  }
  return fmt::format(R"({{"type": "ConvexPolyhedron", "rounding_radius": {}, "vertices": [{}]}})", rounding, text);
}

std::string ellipsoid_json(const Vector3d& a) {
  if (a.x() == a.y() && a.y() == a.z()) return fmt::format(R"({{"type": "Sphere", "diameter": {}}})", 2 * a.x());
  return fmt::format(R"({{"type": "Ellipsoid", "a": {}, "b": {}, "c": {}}})", a.x(), a.y(), a.z());
}

double positive(const JsonMember& shape, const char* key) {
  const JsonMember member = shape.at(key, "a positive number");
  if (!(member.number() > 0)) throw member.bad("a positive number");
  return member.number();
}

constexpr const char* kPoints = "a list of points [x, y, z]";

std::vector<Vector3d> read_vertices(const JsonMember& shape) {
  const JsonMember vertices = shape.at("vertices", kPoints);
  if (!vertices.json->is_array()) throw vertices.bad(kPoints);
  std::vector<Vector3d> points;
  for (std::size_t k = 0; k < vertices.json->size(); ++k) {
    points.push_back(JsonMember{&vertices.json->at(k), fmt::format("vertices[{}]", k)}.vector());
  }
  return points;
}

/// Polyhedron of a row, as it is written.
struct Written {
  std::vector<Vector3d> vertices;
  double rounding = 0;
};

Written read_polyhedron(const JsonMember& shape) {
  Written written{read_vertices(shape)};
  if (!shape.has("rounding_radius")) return written;
  const JsonMember rounding = shape.at("rounding_radius", "a number of at least 0");
  written.rounding = rounding.number();
  if (!(written.rounding >= 0)) throw rounding.bad("a number of at least 0");
  return written;
}

/// Returns the ball that is swept along two points; nullopt if that is no body of revolution about their z axis.
std::optional<ed::BodyShape> capsule_of(const Written& written) {
  const Vector3d half = 0.5 * (written.vertices[1] - written.vertices[0]);
  const Vector3d middle = 0.5 * (written.vertices[1] + written.vertices[0]);
  const double apart = kSameLength * (half.norm() + written.rounding);
  if (!(written.rounding > 0) || middle.norm() > apart || half.head<2>().norm() > apart) return std::nullopt;
  return geom::Capsule(half.norm(), written.rounding);
}

/// Returns a hull of points in a frame that a body may have.
TypeShape moved_polyhedron(const Written& written) {
  FramedPolyhedron framed = framed_polyhedron(written.vertices, written.rounding, kSameLength);
  return {body_shape(framed.shape), framed.X_PB};
}

/// Reads a row as JSON.
nlohmann::json parsed(const std::string& text) {
  try {
    return parse_json(text);
  } catch (const JsonError& error) {
    throw InputError(fmt::format("{}; accepted: a JSON object", error.what()));
  }
}

/// Returns the word of a row; empty if there is none.
std::string type_of(const JsonMember& shape) {
  if (!shape.json->is_object() || !shape.has("type")) return "";
  return shape.at("type", "a name").text("a name");
}

/// Reads an ellipsoid or a sphere.
std::optional<ed::BodyShape> read_ellipsoid(const JsonMember& shape, const std::string& type) {
  Vector3d axes;
  if (type == "Ellipsoid") {
    axes = {positive(shape, "a"), positive(shape, "b"), positive(shape, "c")};
  } else if (type == "Sphere") {
    axes.setConstant(positive(shape, "diameter") / 2);
  } else {
    return std::nullopt;
  }
  return shape.checked([&] { return make_body_shape({ShapeKind::ellipsoid, axes}); });
}

}  // namespace

std::string type_shape_json(const std::optional<ed::BodyShape>& shape, std::size_t types) {
  if (!shape) return "{}";
  const bool fine = types <= kFineTypes;
  if (const std::optional<SweptPolytope> polytope = swept_polytope(*shape)) {
    return polyhedron_json(polytope->vertices, polytope->rounding, fine);
  }
  const ShapeNumbers numbers = numbers_of(*shape);
  if (has_exponents(numbers.kind)) {
    return polyhedron_json(surface_points(numbers, fine ? 11 : 5, fine ? 24 : 8), 0, false);
  }
  return ellipsoid_json(numbers.lengths);
}

std::optional<TypeShape> read_type_shape(const std::string& text) {
  const nlohmann::json json = parsed(text);
  const JsonMember shape{&json, ""};
  const std::string type = type_of(shape);
  if (type != "ConvexPolyhedron") {
    std::optional<ed::BodyShape> read = read_ellipsoid(shape, type);
    return read ? std::optional(TypeShape{std::move(*read)}) : std::nullopt;
  }
  const Written written = read_polyhedron(shape);
  if (written.vertices.size() == 2) {
    std::optional<ed::BodyShape> capsule = shape.checked([&] { return capsule_of(written); });
    return capsule ? std::optional(TypeShape{std::move(*capsule)}) : std::nullopt;
  }
  if (written.vertices.size() < 4) return std::nullopt;
  return shape.checked([&] { return moved_polyhedron(written); });
}

std::optional<ed::BodyShape> read_own_type_shape(const std::string& text, const ed::BodyShape& known) {
  const nlohmann::json json = parsed(text);
  const JsonMember shape{&json, ""};
  const std::string type = type_of(shape);
  if (type != "ConvexPolyhedron") return read_ellipsoid(shape, type);
  if (!swept_polytope(known)) return std::nullopt;
  const Written written = read_polyhedron(shape);
  if (written.vertices.size() == 2) return capsule_of(written);
  return shape.checked([&] {
    return make_body_shape({ShapeKind::polyhedron, Vector3d::Zero(), {1, 1}, written.rounding, written.vertices});
  });
}

}  // namespace hardbody
