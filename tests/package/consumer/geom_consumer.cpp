// hardbody::geom as an outside project sees it: a few answers that are known, and, with the argument "answers", the
// layout of the public types and the bits of many answers, to be compared with those of consumers compiled otherwise.
#include <geom/geom.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <span>
#include <vector>

namespace {

int known_answers() {
  const geom::Ellipsoid needle({1.0, 1.0, 3.0});
  const geom::Ellipsoid ball({0.5, 0.5, 0.5});
  const geom::Pose X_WA, X_WB = geom::Pose::translation({0.0, 0.0, 4.0});
  const geom::DistanceResult r = geom::distance(needle, X_WA, ball, X_WB);
  std::printf("%s %g\n", to_string(r.status), r.distance);
  // Tip to ball along the axis: 4 - 3 - 0.5, to rounding.
  if (!(r.status == geom::DistanceStatus::separated && std::abs(r.distance - 0.5) < 1e-14)) return 1;

  // The kernels of every instruction set are in the library: nothing else has to be found.
  geom::DistanceResult batched;
  const geom::BatchSummary summary =
      geom::distance_batch({&needle, 1}, {&X_WA, 1}, {&ball, 1}, {&X_WB, 1}, {&batched, 1});
  std::printf("%s %g\n", to_string(summary.instruction_set), batched.distance);
  return std::abs(batched.distance - r.distance) < 1e-14 ? 0 : 1;
}

template <class T>
void layout(const char* name) {
  std::printf("%s: %zu bytes, aligned to %zu\n", name, sizeof(T), alignof(T));
}

void print(const geom::DistanceResult& r) {
  std::printf("%s %d %a", to_string(r.status), r.iterations, r.distance);
  for (const Eigen::Vector3d& v : {r.point_a, r.point_b, r.normal}) std::printf(" %a %a %a", v.x(), v.y(), v.z());
  std::printf("\n");
}

/// Numbers that no compile flag can change: quotients of small integers.
geom::Pose pose(int k) {
  const double q[4][4] = {{1, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {0.5, -0.5, 0.5, 0.5}, {0.28, 0.96, 0, 0}};
  const double* w = q[k % 4];
  return geom::Pose::from_quaternion(w[0], w[1], w[2], w[3],
                                     {(k * 7 % 11) / 8.0, (k * 5 % 13) / 4.0, 3.0 + (k * 3 % 17) / 16.0});
}

void answers() {
  layout<geom::Support>("Support");
  layout<geom::Ellipsoid>("Ellipsoid");
  layout<geom::Superellipsoid>("Superellipsoid");
  layout<geom::Shape>("Shape");
  layout<geom::Pose>("Pose");
  layout<geom::OrientedBox>("OrientedBox");
  layout<geom::DistanceOptions>("DistanceOptions");
  layout<geom::DistanceResult>("DistanceResult");
  layout<geom::BatchOptions>("BatchOptions");
  layout<geom::BatchSummary>("BatchSummary");
  layout<geom::WitnessPair>("WitnessPair");
  layout<geom::NewtonOptions>("NewtonOptions");
  layout<geom::ClosestPoint>("ClosestPoint");
  layout<geom::RayHit>("RayHit");

  const geom::Ellipsoid ellipsoids[] = {geom::Ellipsoid({1.0, 1.0, 3.0}), geom::Ellipsoid({2.0, 1.0, 0.5})};
  const geom::Superellipsoid brick({1.0, 2.0, 1.5}, 0.5, 0.75);
  std::vector<geom::Ellipsoid> shapes;
  std::vector<geom::Pose> poses;
  for (int k = 0; k < 100; ++k) {
    shapes.push_back(ellipsoids[k % 2]);
    poses.push_back(pose(k));
  }
  const geom::Pose origin;
  std::vector<geom::DistanceResult> results(shapes.size());
  geom::distance_batch({ellipsoids, 1}, {&origin, 1}, shapes, poses, results);
  for (const geom::DistanceResult& r : results) print(r);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const geom::DistanceResult r = geom::distance(ellipsoids[0], origin, shapes[k], poses[k]);
    print(r);
    print(geom::distance(ellipsoids[0], origin, shapes[k], poses[k], {.start = r.normal}));
    print(geom::distance(brick, origin, shapes[k], poses[k]));
    print(geom::distance(geom::Shape(shapes[k]), poses[k], geom::Shape(brick), origin));
    const geom::WitnessPair seed{r.point_a, r.point_b, geom::SeedStatus::usable};
    print(geom::newton_distance(ellipsoids[0], origin, shapes[k], poses[k], geom::NewtonSystem::eight, seed));
    const Eigen::Vector3d inertia = brick.inertia(2.0);
    std::printf("%a %a %a %a\n", brick.volume(), inertia.x(), inertia.y(), inertia.z());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "answers") == 0) {
    answers();
    return 0;
  }
  return known_answers();
}
