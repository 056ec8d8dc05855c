#include "base/shapes.h"

#include <geom/polyhedron.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// Returns the shape, or the rounded one.
template <class Sharp>
geom::Shape rounded(Sharp sharp, double radius) {
  if (radius == 0) return sharp;
  return geom::Rounded<Sharp>(std::move(sharp), radius);
}

geom::Shape make_ellipsoid(const ShapeNumbers& n) {
  return geom::Ellipsoid(n.lengths);
}
geom::Shape make_superellipsoid(const ShapeNumbers& n) {
  return geom::Superellipsoid(n.lengths, n.exponents.x(), n.exponents.y());
}
geom::Shape make_sphere(const ShapeNumbers& n) {
  return geom::Sphere(n.lengths.x());
}
geom::Shape make_capsule(const ShapeNumbers& n) {
  return geom::Capsule(n.lengths.z(), n.lengths.x());
}
geom::Shape make_box(const ShapeNumbers& n) {
  return rounded(geom::Box(n.lengths), n.rounding);
}
geom::Shape make_polyhedron(const ShapeNumbers& n) {
  return rounded(geom::ConvexPolyhedron(n.vertices), n.rounding);
}

geom::Shape make_cylinder(const ShapeNumbers& n) {
  return rounded(geom::Cylinder(n.lengths.z(), n.lengths.x()), n.rounding);
}
geom::Shape make_cone(const ShapeNumbers& n) {
  return rounded(geom::Cone(n.lengths.z(), n.lengths.x(), -n.lengths.y()), n.rounding);
}

/// Form of the semi-axes of a kind.
enum class Axes { none, in_order, in_any_order };

struct KindProperties {
  const char* name;
  const char* plural;
  Axes axes;
  bool has_exponents;
  geom::Shape (*make)(const ShapeNumbers& numbers);
};

/// Kinds in the order of their numbers.
constexpr std::array<KindProperties, kShapeKinds.size()> kProperties = {{
    {"ellipsoid", "ellipsoids", Axes::in_any_order, false, make_ellipsoid},
    {"superellipsoid", "superellipsoids", Axes::in_order, true, make_superellipsoid},
    {"sphere", "spheres", Axes::none, false, make_sphere},
    {"capsule", "capsules", Axes::none, false, make_capsule},
    {"box", "boxes", Axes::none, false, make_box},
    {"polyhedron", "polyhedra", Axes::none, false, make_polyhedron},
    {"cylinder", "cylinders", Axes::none, false, make_cylinder},
    {"cone", "cones", Axes::none, false, make_cone},
}};

const KindProperties& properties_of(ShapeKind kind) {
  return kProperties.at(static_cast<std::size_t>(kind));
}

ShapeNumbers numbers(const geom::Ellipsoid& shape) {
  return {ShapeKind::ellipsoid, shape.semi_axes()};
}
ShapeNumbers numbers(const geom::Superellipsoid& shape) {
  return {ShapeKind::superellipsoid, shape.semi_axes(), {shape.e1(), shape.e2()}};
}
ShapeNumbers numbers(const geom::Sphere& shape) {
  return {ShapeKind::sphere, Vector3d::Constant(shape.radius())};
}
ShapeNumbers numbers(const geom::Capsule& shape) {
  return {ShapeKind::capsule, {shape.radius(), shape.radius(), shape.half_length()}};
}
ShapeNumbers numbers(const geom::Box& shape) {
  return {ShapeKind::box, shape.half_extents()};
}
ShapeNumbers numbers(const geom::ConvexPolyhedron& shape) {
  ShapeNumbers result{ShapeKind::polyhedron, Vector3d::Zero()};
  for (int k = 0; k < shape.vertex_count(); ++k) result.vertices.push_back(shape.vertex(k));
  return result;
}
ShapeNumbers numbers(const geom::Cylinder& shape) {
  return {ShapeKind::cylinder, {shape.radius(), shape.radius(), shape.half_length()}};
}
ShapeNumbers numbers(const geom::Cone& shape) {
  return {ShapeKind::cone, {shape.radius(), -shape.base(), shape.height()}};
}
template <class Other>
ShapeNumbers numbers(const Other& /*shape*/) {
  throw std::logic_error("a shape that no config or file names");
}
template <class Inner>
ShapeNumbers numbers(const geom::Rounded<Inner>& shape) {
  ShapeNumbers result = numbers(shape.inner());
  result.rounding = shape.radius();
  return result;
}

SweptPolytope polytope(const geom::ConvexPolyhedron& shape) {
  return {numbers(shape).vertices, geom::merged_faces(shape)};
}
SweptPolytope polytope(const geom::Box& shape) {
  std::vector<Vector3d> corners;
  for (int k = 0; k < 8; ++k) {
    const Vector3d side((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1);
    corners.emplace_back(side.cwiseProduct(shape.half_extents()));
  }
  return polytope(geom::ConvexPolyhedron(corners));
}
SweptPolytope polytope(const geom::Capsule& shape) {
  const Vector3d end = shape.half_length() * Vector3d::UnitZ();
  return {{-end, end}, {}, shape.radius()};
}
/// Returns the hull of a lower rim and an upper one, or an apex.
SweptPolytope polytope_of_rims(const std::array<geom::kernel::CoreDisc, 2>& discs) {
  SweptPolytope result;
  std::array<std::vector<int>, 2> rims;
  for (std::size_t side = 0; side < 2; ++side) {
    const int count = discs[side].radius > 0 ? kRimVertices : 1;
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * k / count;
      rims[side].push_back(static_cast<int>(result.vertices.size()));
      result.vertices.emplace_back(discs[side].radius * std::cos(angle), discs[side].radius * std::sin(angle),
                                   discs[side].z);
    }
  }
  const auto& [low, high] = rims;
  for (std::size_t k = 0; k < low.size(); ++k) {
    const std::size_t next = (k + 1) % low.size();
    if (high.size() == 1) {
      result.faces.push_back({low[k], low[next], high[0]});
    } else {
      result.faces.push_back({low[k], low[next], high[next], high[k]});
    }
  }
  result.faces.emplace_back(low.rbegin(), low.rend());
  if (high.size() > 1) result.faces.push_back(high);
  return result;
}
SweptPolytope polytope(const geom::Cylinder& shape) {
  return polytope_of_rims(shape.core().disc);
}
SweptPolytope polytope(const geom::Cone& shape) {
  return polytope_of_rims(shape.core().disc);
}
template <class Inner>
auto polytope(const geom::Rounded<Inner>& shape) -> decltype(polytope(shape.inner())) {
  SweptPolytope result = polytope(shape.inner());
  result.rounding = shape.radius();
  return result;
}

/// Returns whether each vertex has one of the others within `apart`.
bool same_vertices(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b, double apart) {
  if (a.size() != b.size()) return false;
  return std::all_of(a.begin(), a.end(), [&](const Vector3d& x) {
    return std::any_of(b.begin(), b.end(), [&](const Vector3d& y) { return (x - y).norm() <= apart; });
  });
}

/// Returns the numbers, those of a sphere as an ellipsoid.
ShapeNumbers comparable(const ed::BodyShape& shape) {
  ShapeNumbers result = numbers_of(shape);
  if (result.kind == ShapeKind::sphere) result.kind = ShapeKind::ellipsoid;
  return result;
}

}  // namespace

const char* to_string(ShapeKind kind) {
  return properties_of(kind).name;
}

std::optional<ShapeKind> find_shape_kind(std::string_view name) {
  const auto* kind =
      std::find_if(kShapeKinds.begin(), kShapeKinds.end(), [&](ShapeKind k) { return name == to_string(k); });
  return kind == kShapeKinds.end() ? std::nullopt : std::optional(*kind);
}

const char* plural(ShapeKind kind) {
  return properties_of(kind).plural;
}

bool has_semi_axes(ShapeKind kind) {
  return properties_of(kind).axes != Axes::none;
}

bool has_exponents(ShapeKind kind) {
  return properties_of(kind).has_exponents;
}

bool has_equivalent_axes(ShapeKind kind) {
  return properties_of(kind).axes == Axes::in_any_order;
}

ShapeNumbers numbers_of(const ed::BodyShape& shape) {
  return std::visit([](const auto& s) { return numbers(s); }, shape);
}

geom::Shape make_shape(const ShapeNumbers& numbers) {
  return properties_of(numbers.kind).make(numbers);
}

ed::BodyShape make_body_shape(const ShapeNumbers& numbers) {
  return body_shape(make_shape(numbers));
}

ed::BodyShape body_shape(const geom::Shape& shape) {
  return std::visit([](const auto& s) { return ed::BodyShape(s); }, shape);
}

geom::Shape geom_shape(const ed::BodyShape& shape) {
  return std::visit(
      [](const auto& s) -> geom::Shape {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(s)>, ed::CustomShape>) {
          throw std::logic_error("a user's own shape in a file");
        } else {
          return s;
        }
      },
      shape);
}

FramedPolyhedron framed_polyhedron(const std::vector<Vector3d>& points, double rounding, double apart) {
  geom::Pose X_PB;
  geom::ConvexPolyhedron moved = geom::ConvexPolyhedron::in_principal_frame(points, &X_PB, rounding);
  if (X_PB.position().norm() <= apart * moved.bounding_radius()) {
    geom::Rounded<geom::ConvexPolyhedron> own(geom::ConvexPolyhedron(points), rounding);
    if (own.is_in_principal_frame()) return {rounded(own.inner(), rounding)};
  }
  return {rounded(std::move(moved), rounding), X_PB};
}

std::optional<SweptPolytope> swept_polytope(const ed::BodyShape& shape) {
  return std::visit(
      [](const auto& s) -> std::optional<SweptPolytope> {
        if constexpr (requires { polytope(s); }) return polytope(s);
        return std::nullopt;
      },
      shape);
}

bool same_shape(const ed::BodyShape& a, const ed::BodyShape& b, double lengths, double exponents) {
  const ShapeNumbers p = comparable(a);
  const ShapeNumbers q = comparable(b);
  const auto has_rims = [](const ShapeNumbers& n) {
    return n.kind == ShapeKind::cylinder || n.kind == ShapeKind::cone;
  };
  const bool by_numbers = has_rims(p) && has_rims(q);
  const std::optional<SweptPolytope> s = by_numbers ? std::nullopt : swept_polytope(a);
  const std::optional<SweptPolytope> t = by_numbers ? std::nullopt : swept_polytope(b);
  if (s.has_value() != t.has_value()) return false;
  const double apart = lengths * ed::bounding_radius(b);
  if (s) return same_vertices(s->vertices, t->vertices, apart) && std::abs(s->rounding - t->rounding) <= apart;
  return p.kind == q.kind && (p.exponents - q.exponents).cwiseAbs().maxCoeff() <= exponents &&
         (p.lengths - q.lengths).norm() <= lengths * q.lengths.norm() &&
         std::abs(p.rounding - q.rounding) <= lengths * q.lengths.norm();
}

}  // namespace hardbody
