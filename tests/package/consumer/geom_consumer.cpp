// hardbody::geom as an outside project sees it: a few answers that are known, and, with the argument "answers", the
// layout of the public types and the bits of many answers, to be compared with those of consumers compiled otherwise.
#include <geom/geom.h>

#include <Eigen/LU>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <span>
#include <vector>

namespace {

bool near(double value, double wanted) {
  return std::abs(value - wanted) < 1e-14;
}

/// Distances of one pair, tip to ball along the axis: 4 - 3 - 0.5, to rounding.
int wrong_distances() {
  const geom::Ellipsoid needle({1.0, 1.0, 3.0});
  const geom::Ellipsoid ball({0.5, 0.5, 0.5});
  const geom::Pose X_WA, X_WB = geom::Pose::translation({0.0, 0.0, 4.0});
  const geom::DistanceResult r = geom::distance(needle, X_WA, ball, X_WB);
  std::printf("%s %g\n", to_string(r.status), r.distance);
  int wrong = r.status != geom::DistanceStatus::separated || !near(r.distance, 0.5);

  // The kernels of every instruction set are in the library: nothing else has to be found.
  geom::DistanceResult batched;
  const geom::BatchSummary summary =
      geom::distance_batch({&needle, 1}, {&X_WA, 1}, {&ball, 1}, {&X_WB, 1}, {&batched, 1});
  std::printf("%s %g\n", to_string(summary.instruction_set), batched.distance);
  wrong += !near(batched.distance, r.distance);

  const geom::WitnessPair seed = geom::dual_seed(needle, X_WA, ball, X_WB);
  wrong += !near(geom::newton_distance(needle, X_WA, ball, X_WB, geom::NewtonSystem::five, seed).distance, 0.5);
  wrong += geom::distance(needle, X_WA, ball, geom::Pose::translation({0.0, 0.0, 3.4})).status !=
           geom::DistanceStatus::overlapping;
  return wrong;
}

/// The other questions of geom/queries.h, of a shape whose surface meets its axes at 1, 2 and 1.5.
template <class Shape>
int wrong_queries(const Shape& shape) {
  const geom::Pose X_WA, X_WB = geom::Pose::translation({5.0, 0.0, 0.0});
  const Eigen::Vector3d e(1.0, 0.0, 0.0);
  // Never above the gap of 3, below it by what is taken off for rounding, and as much again for rounding itself;
  // nothing lies farther than 2.7 from a centre.
  const double bound = geom::distance_lower_bound(shape, X_WA, shape, X_WB, e);
  int wrong = bound > 3.0 || bound < 3.0 - 2 * geom::kLowerBoundRounding * (5.0 + 2.7 + 2.7);
  wrong += geom::overlap(shape, X_WA, shape, X_WB) != geom::Answer::no;
  wrong += geom::overlap(shape, X_WA, shape, geom::Pose::translation(1.5 * e)) != geom::Answer::yes;
  const geom::ClosestPoint closest = geom::closest_point(shape, X_WA, 3.0 * e);
  wrong += !near(closest.distance, 2.0) || !near(closest.point.x(), 1.0) || !near(closest.normal.x(), 1.0);
  wrong += !geom::contains(shape, X_WA, 0.99 * e) || geom::contains(shape, X_WA, 1.01 * e);
  const geom::RayHit hit = geom::ray_cast(shape, X_WA, 3.0 * e, -2.0 * e);
  wrong += hit.status != geom::RayStatus::hit || !near(hit.t, 1.0);
  wrong += geom::ray_cast(shape, X_WA, 3.0 * e, {0.0, 1.0, 0.0}).status != geom::RayStatus::missed;
  wrong += !near(geom::oriented_box(shape, X_WB).half_extents.y(), 2.0);
  return wrong;
}

int known_answers() {
  const geom::Superellipsoid brick({1.0, 2.0, 1.5}, 0.5, 0.75);
  const geom::Ellipsoid egg({1.0, 2.0, 1.5});
  const geom::Shape any = brick;
  int wrong = wrong_distances() + wrong_queries(egg) + wrong_queries(brick) + wrong_queries(any);
  for (const double height : {brick.support({0.0, 3.0, 0.0}).height, geom::support(any, {0.0, 3.0, 0.0}).height}) {
    wrong += !near(height, 6.0);
  }
  std::printf("%d wrong\n", wrong);
  return wrong == 0 ? 0 : 1;
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

/// A shape of the consumer's own.
struct Ball {
  double radius;

  double value(const Eigen::Vector3d& x) const { return x.squaredNorm() - radius * radius; }
  Eigen::Vector3d gradient(const Eigen::Vector3d& x) const { return 2 * x; }
  Eigen::Matrix3d hessian(const Eigen::Vector3d& /*x*/) const { return 2 * Eigen::Matrix3d::Identity(); }
};

/// Prints an answer of templates to nine digits: they are compiled here too, with other roundings.
void print_digits(const char* name, double x) {
  std::printf("%s %.9e\n", name, x);
}

/// Functions that both this program and the library contain, some of them on objects whose alignment depends on the
/// flags: the linker keeps one copy of each.
void answers_of_templates() {
  Eigen::Matrix4d four = 3 * Eigen::Matrix4d::Identity();
  four(0, 3) = four(2, 1) = 1;
  print_digits("4 x 4", four.partialPivLu().solve(Eigen::Vector4d(1, 2, 3, 4)).norm());
  Eigen::Matrix<double, 8, 8> eight = 3 * Eigen::Matrix<double, 8, 8>::Identity();
  eight(0, 7) = eight(5, 1) = 1;
  print_digits("8 x 8", eight.partialPivLu().solve(Eigen::Matrix<double, 8, 1>::Ones()).norm());

  const geom::Pose origin;
  const geom::Superellipsoid brick({1.0, 2.0, 1.5}, 0.5, 0.75);
  const geom::Superellipsoid sharp({1.0, 0.7, 1.2}, 1.5, 1.3);
  const Ball ball{0.7};
  for (int k = 0; k < 100; ++k) {
    const geom::Pose far(pose(k).rotation(), pose(k).position() + Eigen::Vector3d(0.0, 0.0, 2.0));
    print_digits("distance", geom::distance(brick, origin, sharp, far).distance);
    const geom::Ellipsoid egg({2.0, 1.0, 0.5});
    print_digits("Newton, ellipsoids", geom::newton_distance(egg, origin, egg, far, geom::NewtonSystem::eight,
                                                             geom::dual_seed(egg, origin, egg, far))
                                           .distance);
    print_digits("closest", geom::closest_point(brick, origin, far.position()).distance);
    for (const geom::NewtonSystem system : {geom::NewtonSystem::eight, geom::NewtonSystem::five}) {
      const geom::WitnessPair seed = geom::dual_seed(brick, origin, sharp, far);
      print_digits("Newton", geom::newton_distance(brick, origin, sharp, far, system, seed).distance);
      print_digits("Newton, Shape", geom::newton_distance(geom::Shape(brick), origin, geom::Shape(sharp), far, system,
                                                          geom::dual_seed(brick, origin, sharp, far))
                                        .distance);
      const geom::Pose X_ball = geom::Pose::translation(far.position());
      const geom::WitnessPair centres = geom::centre_seed(brick, origin, ball, X_ball);
      print_digits("Newton, ball", geom::newton_distance(brick, origin, ball, X_ball, system, centres).distance);
    }
  }
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
    const Eigen::Vector3d inertia = brick.inertia(2.0);
    std::printf("%a %a %a %a\n", brick.volume(), inertia.x(), inertia.y(), inertia.z());
  }
  answers_of_templates();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "answers") == 0) {
    answers();
    return 0;
  }
  return known_answers();
}
