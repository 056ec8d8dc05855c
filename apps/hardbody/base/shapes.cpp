#include "base/shapes.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

struct KindProperties {
  const char* name;
  bool has_exponents;
  bool has_equivalent_axes;
};

KindProperties properties_of(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::ellipsoid:
      return {"ellipsoid", false, true};
    case ShapeKind::superellipsoid:
      return {"superellipsoid", true, false};
  }
  throw std::logic_error("an unknown kind of shape");
}

ShapeNumbers numbers(const geom::Ellipsoid& shape) {
  return {ShapeKind::ellipsoid, shape.semi_axes()};
}

ShapeNumbers numbers(const geom::Superellipsoid& shape) {
  return {ShapeKind::superellipsoid, shape.semi_axes(), {shape.e1(), shape.e2()}};
}

template <class Shape>
ShapeNumbers numbers(const Shape& /*shape*/) {
  throw std::logic_error("a shape that no config or file names");
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

bool has_exponents(ShapeKind kind) {
  return properties_of(kind).has_exponents;
}

bool has_equivalent_axes(ShapeKind kind) {
  return properties_of(kind).has_equivalent_axes;
}

ShapeNumbers numbers_of(const ed::BodyShape& shape) {
  return std::visit([](const auto& s) { return numbers(s); }, shape);
}

Eigen::Vector2d superellipsoid_exponents(const ed::BodyShape& shape) {
  const ShapeNumbers numbers = numbers_of(shape);
  switch (numbers.kind) {
    case ShapeKind::ellipsoid:
    case ShapeKind::superellipsoid:
      return numbers.exponents;
  }
  throw std::logic_error("a shape that is no superellipsoid");
}

geom::Shape make_shape(const ShapeNumbers& numbers) {
  switch (numbers.kind) {
    case ShapeKind::ellipsoid:
      return geom::Ellipsoid(numbers.semi_axes);
    case ShapeKind::superellipsoid:
      return geom::Superellipsoid(numbers.semi_axes, numbers.exponents.x(), numbers.exponents.y());
  }
  throw std::logic_error("an unknown kind of shape");
}

ed::BodyShape make_body_shape(const ShapeNumbers& numbers) {
  return std::visit([](auto shape) { return ed::BodyShape(std::move(shape)); }, make_shape(numbers));
}

bool same_shape(const ed::BodyShape& a, const ed::BodyShape& b, double lengths, double exponents) {
  const ShapeNumbers p = numbers_of(a);
  const ShapeNumbers q = numbers_of(b);
  return p.kind == q.kind && (p.exponents - q.exponents).cwiseAbs().maxCoeff() <= exponents &&
         (p.semi_axes - q.semi_axes).norm() <= lengths * q.semi_axes.norm();
}

}  // namespace hardbody
