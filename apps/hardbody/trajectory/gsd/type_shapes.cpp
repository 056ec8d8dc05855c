#include "trajectory/gsd/type_shapes.h"

#include "base/errors.h"
#include "base/shapes.h"
#include "io/json_member.h"

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
  const Vector3d& a = shape.semi_axes;
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

std::string polyhedron_json(const ShapeNumbers& shape, bool fine) {
  std::string vertices;
  for (const Vector3d& p : surface_points(shape, fine ? 11 : 5, fine ? 24 : 8)) {
    vertices += fmt::format("{}[{:.7g}, {:.7g}, {:.7g}]", vertices.empty() ? "" : ", ", p.x(), p.y(), p.z());
  }
  return fmt::format(R"({{"type": "ConvexPolyhedron", "rounding_radius": 0, "vertices": [{}]}})", vertices);
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

}  // namespace

std::string type_shape_json(const std::optional<ed::BodyShape>& shape, std::size_t types) {
  if (!shape) return "{}";
  const ShapeNumbers numbers = numbers_of(*shape);
  switch (numbers.kind) {
    case ShapeKind::ellipsoid:
      return ellipsoid_json(numbers.semi_axes);
    case ShapeKind::superellipsoid:
      return polyhedron_json(numbers, types <= kFineTypes);
  }
  return "{}";
}

std::optional<ed::BodyShape> read_type_shape(const std::string& text) {
  nlohmann::json json;
  try {
    json = parse_json(text);
  } catch (const JsonError& error) {
    throw InputError(fmt::format("{}; accepted: a JSON object", error.what()));
  }
  const JsonMember shape{&json, ""};
  if (!json.is_object() || !shape.has("type")) return std::nullopt;
  const std::string type = shape.at("type", "a name").text("a name");
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

}  // namespace hardbody
