#include <geom/newton.h>

namespace geom {

static_assert(ImplicitSurface<Ellipsoid> && SupportShape<Ellipsoid>);

const char* to_string(SeedStatus status) {
  switch (status) {
    case SeedStatus::usable:
      return "usable";
    case SeedStatus::overlapping:
      return "overlapping";
    case SeedStatus::declined:
      return "declined";
  }
  return "unknown";
}

const char* to_string(NewtonSystem system) {
  switch (system) {
    case NewtonSystem::eight:
      return "eight";
    case NewtonSystem::five:
      return "five";
  }
  return "unknown";
}

DistanceResult kernel::newton_distance_unchecked(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b,
                                                 const Pose& X_WB, NewtonSystem system, const WitnessPair& seed,
                                                 const NewtonOptions& options) {
  return newton_distance_unchecked<Ellipsoid, Ellipsoid>(a, X_WA, b, X_WB, system, seed, options);
}

DistanceResult newton_distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                               NewtonSystem system, const WitnessPair& seed, const NewtonOptions& options) {
  check_seed(a, X_WA, b, X_WB, seed);
  return kernel::newton_distance_unchecked(a, X_WA, b, X_WB, system, seed, options);
}

}  // namespace geom
