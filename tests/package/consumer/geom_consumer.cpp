#include <geom/geom.h>

#include <cmath>
#include <iostream>

int main() {
  const geom::Ellipsoid needle({1.0, 1.0, 3.0});
  const geom::Ellipsoid ball({0.5, 0.5, 0.5});
  const geom::Pose X_WA, X_WB = geom::Pose::translation({0.0, 0.0, 4.0});
  const geom::DistanceResult r = geom::distance(needle, X_WA, ball, X_WB);
  std::cout << to_string(r.status) << ' ' << r.distance << '\n';
  // Tip to ball along the axis: 4 - 3 - 0.5, to rounding.
  if (!(r.status == geom::DistanceStatus::separated && std::abs(r.distance - 0.5) < 1e-14)) return 1;

  // The kernels of every instruction set are in the library: nothing else has to be found.
  geom::DistanceResult batched;
  const geom::BatchSummary summary =
      geom::distance_batch({&needle, 1}, {&X_WA, 1}, {&ball, 1}, {&X_WB, 1}, {&batched, 1});
  std::cout << to_string(summary.instruction_set) << ' ' << batched.distance << '\n';
  return std::abs(batched.distance - r.distance) < 1e-14 ? 0 : 1;
}
