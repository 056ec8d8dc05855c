#pragma once

/// Table of the kinds of shapes that a config may have: the keys of each, the shape that they make, and its texts. A
/// new kind is an entry here, in base/shapes.cpp and, for its keys, in shape_keys.cpp.

#include "config/config.h"

#include <geom/any_shape.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Reason why the value of one key of a shape is not taken together with the others.
struct ShapeRefusal {
  std::string key;  ///< last part of its name
  std::string accepted;
  std::string why = {};
};

/// Keys of a kind of shape, and what they make.
struct ShapeForm {
  ShapeKind kind;
  std::vector<std::vector<std::string_view>> needed;  ///< exactly one key of each list has to be there
  std::vector<std::string_view> others;               ///< keys that may be there
  /// Returns why the values do not go together; nullopt: they do. Null: always.
  std::optional<ShapeRefusal> (*check)(const ShapeConfig& shape);
  /// Returns the shape in the lengths that were given; `literal`: [[species]], where lengths are kept.
  geom::Shape (*make)(const ShapeConfig& shape, bool literal);
  /// Returns the keys of a shape as TOML, to the last bit.
  std::string (*toml)(const ShapeNumbers& numbers);
  /// Returns what a title says: "capsules, length / diameter = 2". Null for kinds with semi-axes.
  std::string (*title)(const ShapeConfig& shape);
  /// Returns the lengths in use: "length 2, diameter 1". Null for kinds with semi-axes.
  std::string (*lengths)(const ed::BodyShape& shape);

  bool has(std::string_view key) const;
};

/// Returns the form of a kind.
const ShapeForm& form_of(ShapeKind kind);

/// Returns `"box" or "polyhedron"`, the kinds that have a key.
std::string kinds_with(std::string_view key);

/// Returns "a capsule", "an ellipsoid".
std::string with_article(ShapeKind kind);

/// Returns the index of the axis in `semi_axes` that becomes body z; -1: all axes stay as they are given.
int axis_moved_last(const ShapeConfig& shape);

/// Returns the values about body x, y, z after the permutation that makes `axis` the z axis; those of -1 stay.
Eigen::Vector3d axis_last(const Eigen::Vector3d& v, int axis);

}  // namespace hardbody
