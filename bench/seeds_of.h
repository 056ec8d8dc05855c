#pragma once

/// Seeds of the distance equations that this build has, by name.

#include <geom/geom.h>
#ifdef HARDBODY_WITH_SEEDS
#include <geom/seeds.h>
#endif
#ifdef HARDBODY_WITH_CGAL
#include <geom/cgal.h>
#endif

#include <functional>
#include <map>
#include <string>

namespace bench {

template <class Shape>
using SeedOf = std::function<geom::WitnessPair(const Shape&, const geom::Pose&, const Shape&, const geom::Pose&)>;

template <class Shape>
std::map<std::string, SeedOf<Shape>> seeds_of() {
  std::map<std::string, SeedOf<Shape>> seeds;
  seeds["dual"] = [](const auto&... pair) { return geom::dual_seed(pair...); };
  seeds["centres"] = [](const auto&... pair) { return geom::centre_seed(pair...); };
#ifdef HARDBODY_WITH_SEEDS
  seeds["fcl"] = [](const auto&... pair) { return geom::fcl_seed(pair...); };
  seeds["ccd"] = [](const auto&... pair) { return geom::ccd_seed(pair...); };
#endif
#ifdef HARDBODY_WITH_CGAL
  seeds["cgal"] = [](const auto&... pair) { return geom::cgal_seed(pair...); };
#endif
  return seeds;
}

}  // namespace bench
