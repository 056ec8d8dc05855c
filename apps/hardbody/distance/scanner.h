#pragma once

#include "base/shapes.h"

#include <array>
#include <optional>
#include <string_view>

namespace hardbody {

/// Numbers and names in a line of `hardbody distance`, not validated yet.
struct ScannedBody {
  ShapeKind kind = ShapeKind::ellipsoid;
  std::array<double, 3> semi_axes{};
  std::array<double, 2> exponents{};
  std::array<double, 3> position{};
  std::optional<std::array<double, 4>> orientation;
};

struct ScannedQuery {
  ScannedBody a, b;
  std::string_view method, seed, penetration, query;  ///< empty: absent
  std::string_view id;                                ///< JSON text; empty: absent
};

/// Reads a line of the usual form: an object with known keys, each once, in any order; every value of the expected
/// type; strings of plain characters; numbers of JSON's form. Returns nullopt for all other lines, valid or not: those
/// are for parse_json, which takes five times as long and produces the error messages.
std::optional<ScannedQuery> scan_query(std::string_view line);

}  // namespace hardbody
