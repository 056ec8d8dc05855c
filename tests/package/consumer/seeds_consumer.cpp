// hardbody::geom_seeds, and hardbody::geom_cgal if the project asked for it.
#ifdef WITH_CGAL
#include <geom/cgal.h>
#endif
#include <geom/geom.h>
#include <geom/seeds.h>

#include <cmath>
#include <iostream>
#include <vector>

int main() {
  const geom::Ellipsoid needle({1.0, 1.0, 3.0});
  const geom::Ellipsoid ball({0.5, 0.5, 0.5});
  const geom::Pose X_WA, X_WB = geom::Pose::translation({0.0, 1.0, 4.0});
  const geom::DistanceResult wanted = geom::distance(needle, X_WA, ball, X_WB);
  std::vector<geom::WitnessPair> seeds = {geom::fcl_seed(needle, X_WA, ball, X_WB),
                                          geom::ccd_seed(needle, X_WA, ball, X_WB),
                                          geom::fcl_seed(geom::Shape(needle), X_WA, geom::Shape(ball), X_WB),
                                          geom::ccd_seed(geom::Shape(needle), X_WA, geom::Shape(ball), X_WB)};
#ifdef WITH_CGAL
  seeds.push_back(geom::cgal_seed(needle, X_WA, ball, X_WB));
  seeds.push_back(geom::cgal_seed(geom::Shape(needle), X_WA, geom::Shape(ball), X_WB));
#endif
  int failures = 0;
  for (const geom::WitnessPair& seed : seeds) {
    const geom::DistanceResult r = geom::newton_distance(needle, X_WA, ball, X_WB, geom::NewtonSystem::eight, seed);
    std::cout << to_string(seed.status) << ' ' << to_string(r.status) << ' ' << r.distance << '\n';
    // Two exact methods: they agree to rounding.
    if (!(std::abs(r.distance - wanted.distance) < 1e-13)) ++failures;
  }
  return failures;
}
