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

/// A way to guess closest points, by the name that queries use.
struct SeedSource {
  std::string_view name;
  SeedFunction function;    ///< nullptr: not built in
  std::string_view option;  ///< of CMake, that builds it in; empty: always there
};

/// The default first.
std::span<const SeedSource> seed_sources();

/// "dual", "centres", ..: those that are built in, as messages list them.
std::string built_in_seeds();

}  // namespace hardbody
