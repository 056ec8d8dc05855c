#include "distance_seeds.h"

#if HARDBODY_WITH_SEEDS
#include <geom/seeds.h>
#endif
#if HARDBODY_WITH_CGAL
#include <geom/cgal.h>
#endif

#include <fmt/format.h>

#include <variant>

namespace hardbody {
namespace {

/// A seed of libgeom for the shapes inside, which are chosen at run time.
template <auto Seed>
geom::WitnessPair of_shapes(const geom::Shape& a, const geom::Pose& X_WA, const geom::Shape& b,
                            const geom::Pose& X_WB) {
  return std::visit([&](const auto& s, const auto& t) { return Seed(s, X_WA, t, X_WB); }, a, b);
}

constexpr SeedFunction kDual = of_shapes<[](const auto&... pair) { return geom::dual_seed(pair...); }>;
constexpr SeedFunction kCentres = of_shapes<[](const auto&... pair) { return geom::centre_seed(pair...); }>;

#if HARDBODY_WITH_SEEDS
constexpr SeedFunction kFcl = of_shapes<[](const auto&... pair) { return geom::fcl_seed(pair...); }>;
constexpr SeedFunction kCcd = of_shapes<[](const auto&... pair) { return geom::ccd_seed(pair...); }>;
#else
constexpr SeedFunction kFcl = nullptr;
constexpr SeedFunction kCcd = nullptr;
#endif

#if HARDBODY_WITH_CGAL
constexpr SeedFunction kCgal = of_shapes<[](const auto&... pair) { return geom::cgal_seed(pair...); }>;
#else
constexpr SeedFunction kCgal = nullptr;
#endif

constexpr SeedSource kSources[] = {
    {"dual", kDual, ""},
    {"centres", kCentres, ""},
    {"fcl", kFcl, "HARDBODY_WITH_SEEDS"},
    {"ccd", kCcd, "HARDBODY_WITH_SEEDS"},
    {"cgal", kCgal, "HARDBODY_WITH_CGAL"},
};

}  // namespace

std::span<const SeedSource> seed_sources() {
  return kSources;
}

std::string built_in_seeds() {
  std::string list;
  for (const SeedSource& source : kSources) {
    if (source.function != nullptr) list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", source.name);
  }
  return list;
}

}  // namespace hardbody
