#pragma once

/// Kinds of shapes that configs and files name, and the numbers that define one of each. The sources of this pair are
/// the only place of the program that tells kinds apart by their type.

#include <ed/shape.h>

#include <geom/any_shape.h>

#include <Eigen/Core>

#include <array>
#include <optional>
#include <string_view>

namespace hardbody {

/// Kind of shape; GSD files of this program store the values.
enum class ShapeKind { ellipsoid = 0, superellipsoid = 1 };

inline constexpr std::array kShapeKinds = {ShapeKind::ellipsoid, ShapeKind::superellipsoid};

/// Returns the word that configs and files have for a kind.
const char* to_string(ShapeKind kind);

/// Returns the kind of this name; nullopt if there is none.
std::optional<ShapeKind> find_shape_kind(std::string_view name);

/// Returns whether shapes of a kind are defined by exponents, too.
bool has_exponents(ShapeKind kind);

/// Returns whether semi-axes (a, b, c) and (b, c, a) are one body of a kind, rotated.
bool has_equivalent_axes(ShapeKind kind);

/// Numbers that define a shape in configs and files.
struct ShapeNumbers {
  ShapeKind kind = ShapeKind::ellipsoid;
  Eigen::Vector3d semi_axes{1, 1, 1};
  Eigen::Vector2d exponents{1, 1};  ///< e1, e2; 1, 1 for kinds without exponents
};

/// Returns the numbers of a shape. Throws std::logic_error for a user's shape, which no config or file can name.
ShapeNumbers numbers_of(const ed::BodyShape& shape);

/// Returns the exponents of the superellipsoid that a shape is; those of an ellipsoid are 1, 1. Throws std::logic_error
/// for shapes that are none.
Eigen::Vector2d superellipsoid_exponents(const ed::BodyShape& shape);

/// Returns the shape of these numbers. Throws std::invalid_argument if libgeom refuses them.
geom::Shape make_shape(const ShapeNumbers& numbers);
/// Returns the same shape for a body in motion. Throws std::invalid_argument if libgeom refuses the numbers.
ed::BodyShape make_body_shape(const ShapeNumbers& numbers);

/// Returns whether two shapes are of one kind and agree: their semi-axes within `lengths`, relative to those of `b`,
/// and their exponents within `exponents`.
bool same_shape(const ed::BodyShape& a, const ed::BodyShape& b, double lengths, double exponents);

}  // namespace hardbody
