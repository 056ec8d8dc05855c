#include "base/shapes.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

ShapeNumbers numbers(const geom::Ellipsoid& shape) {
  return {ShapeKind::ellipsoid, shape.semi_axes()};
}

ShapeNumbers numbers(const geom::Superellipsoid& shape) {
  return {ShapeKind::superellipsoid, shape.semi_axes(), {shape.e1(), shape.e2()}};
}

ShapeNumbers numbers(const ed::CustomShape& /*shape*/) {
  throw std::logic_error("a user's own shape in a config or file");
}

}  // namespace

const char* to_string(ShapeKind kind) {
  return kind == ShapeKind::ellipsoid ? "ellipsoid" : "superellipsoid";
}

std::optional<ShapeKind> find_shape_kind(std::string_view name) {
  const auto* kind =
      std::find_if(kShapeKinds.begin(), kShapeKinds.end(), [&](ShapeKind k) { return name == to_string(k); });
  return kind == kShapeKinds.end() ? std::nullopt : std::optional(*kind);
}

ShapeNumbers numbers_of(const ed::BodyShape& shape) {
  return std::visit([](const auto& s) { return numbers(s); }, shape);
}

geom::Shape make_shape(const ShapeNumbers& numbers) {
  if (numbers.kind == ShapeKind::ellipsoid) return geom::Ellipsoid(numbers.semi_axes);
  return geom::Superellipsoid(numbers.semi_axes, numbers.exponents.x(), numbers.exponents.y());
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
