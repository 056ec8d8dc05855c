#pragma once

/// Dispatch over AnyShape with few cases: all CoreShapes are one, a CoreBody.

#include <geom/distance.h>
#include <geom/kernel/refuse.h>
#include <geom/shape_variant.h>

#include <string>
#include <type_traits>
#include <variant>

namespace geom::kernel {

/// Returns f(body), the body an Ellipsoid, a Superellipsoid, a CoreBody, or one of the other shapes of the variant.
template <class... Shapes, class F>
decltype(auto) with_body(const std::variant<Shapes...>& shape, F&& f) {
  return std::visit(
      [&f](const auto& s) -> decltype(auto) {
        if constexpr (CoreShape<std::decay_t<decltype(s)>>) {
          return f(CoreBody(s));
        } else {
          return f(s);
        }
      },
      shape);
}

/// Returns f(body_a, body_b), of bodies as with_body() has them.
template <class AnyA, class AnyB, class F>
decltype(auto) with_bodies(const AnyA& a, const AnyB& b, F&& f) {
  return with_body(a, [&](const auto& s) -> decltype(auto) {
    return with_body(b, [&](const auto& t) -> decltype(auto) { return f(s, t); });
  });
}

/// Throws std::invalid_argument: the paper's equations, which `what` solves, are not those of this shape.
[[noreturn]] GEOM_EXPORT void refuse_equations(const std::string& what, const Shape& shape);

/// Returns f(surface) with the Ellipsoid or Superellipsoid that the shape is, a sphere too, for the paper's equations.
/// Throws std::invalid_argument, naming `what`, for all others (has_equations).
template <class F>
auto with_equations(const char* what, const Shape& shape, F&& f) {
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) return f(*ellipsoid);
  if (const auto* superellipsoid = std::get_if<Superellipsoid>(&shape)) return f(*superellipsoid);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return f(sphere->ellipsoid());
  refuse_equations(what, shape);
}

}  // namespace geom::kernel
