#pragma once

#include <geom/any_shape.h>
#include <geom/newton.h>
#include <geom/pose.h>

#include <span>
#include <string>
#include <string_view>

namespace hardbody {

using SeedFunction = geom::WitnessPair (*)(const geom::Shape& a, const geom::Pose& X_WA, const geom::Shape& b,
                                           const geom::Pose& X_WB);

/// Method of guessing closest points, by its name in queries.
struct SeedSource {
  std::string_view name;
  SeedFunction function;    ///< nullptr: not built in
  std::string_view option;  ///< CMake option that builds it in; empty: always available
};

/// Returns all methods, the default first.
std::span<const SeedSource> seed_sources();

/// Returns the names of those built in, "dual", "centres", .., as messages list them.
std::string built_in_seeds();

}  // namespace hardbody
