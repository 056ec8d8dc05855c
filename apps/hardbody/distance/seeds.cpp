#include "distance/seeds.h"

#if HARDBODY_WITH_SEEDS
#include <geom/seeds.h>
#endif
#if HARDBODY_WITH_CGAL
#include <geom/cgal.h>
#endif

#include <fmt/format.h>

namespace hardbody {
namespace {

constexpr SeedFunction kDual = geom::dual_seed;
constexpr SeedFunction kCentres = geom::centre_seed;

#if HARDBODY_WITH_SEEDS
constexpr SeedFunction kFcl = geom::fcl_seed;
constexpr SeedFunction kCcd = geom::ccd_seed;
#else
constexpr SeedFunction kFcl = nullptr;
constexpr SeedFunction kCcd = nullptr;
#endif

#if HARDBODY_WITH_CGAL
constexpr SeedFunction kCgal = geom::cgal_seed;
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
