#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace hardbody {

/// The numbers and names of a line of `hardbody distance`, not looked at yet.
struct ScannedBody {
  bool is_superellipsoid = false;
  std::array<double, 3> semi_axes{};
  std::array<double, 2> exponents{};
  std::array<double, 3> position{};
  std::optional<std::array<double, 4>> orientation;
};

struct ScannedQuery {
  ScannedBody a, b;
  std::string_view method, seed, penetration;  ///< empty: not there
  std::string_view id;                         ///< JSON text; empty: not there
};

/// Reads a line that is as nearly all are: an object with known keys, each once, in any order; every value of the type
/// that it should have; strings of plain characters; numbers of JSON's form. Nothing for all other lines, good or bad:
/// those are for parse_json, which takes five times as long and knows what to complain about.
std::optional<ScannedQuery> scan_query(std::string_view line);

}  // namespace hardbody
