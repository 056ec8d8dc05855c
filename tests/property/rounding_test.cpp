// What rounding may hide, and that certified steps pay for it: pairs 1e-14 to 1e-12 of their size apart, about to
// touch, to graze or to part, judged in quadruple precision. No step may pass a contact of the exact bodies; made
// without the rounding terms the same steps do. HARDBODY_FULL=1: a million pairs.

#include "property/rounding_judge.h"

#include <common/finder/ensemble.h>
#include <common/finder/scale.h>
#include <common/geom/exact_bodies.h>
#include <common/geom/shapes.h>

#include <base/periodic.h>
#include <contact/body_shapes.h>
#include <contact/certified.h>
#include <contact/convex/gap.h>
#include <contact/support_gap.h>
#include <contact/uniaxial_gap.h>

#include <ed/random.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <utility>

namespace ed::internal {
namespace {

using quad::ExactPair;
using quad::ExactPath;

// ---- States --------------------------------------------------------------------------------------------------------

/// Time and place of bodies whose clocks, places and images have nothing to do with each other.
struct Scene {
  double now, t, box;

  Scene(Random& random, double size) : now(random.uniform()), t(now), box(3 * size * (1 + 3 * random.uniform())) {}
};

/// The exact bodies' images.
struct Image {
  Vector3d r_now;
  quad::Quad3 shift;

  template <class Motion>
  Image(const Motion& a, const Motion& b, const Scene& scene) {
    const Vector3d d = b.position_at(scene.now) - a.position_at(scene.now);
    r_now = nearest_image(d, scene.box);
    const Vector3d boxes = ((r_now - d) / scene.box).array().round();
    shift = static_cast<Quad>(scene.box) * quad::Quad3(boxes);
  }
};

/// Moves B so that it is `gap` from A at scene.t along n, and parts from it at `rate`. `gap_of(image)` makes the
/// pair gap, `points(pair_gap, state)` are the support points of both, each from its own centre.
template <class Motion, class GapOf, class Points>
void arrange(Random& random, const Scene& scene, const Vector3d& n, double gap, Motion& a, Motion& b,
             const GapOf& gap_of, const Points& points) {
  const auto place = [&] {
    const auto pair_gap = gap_of(Image(a, b, scene));
    const auto [p_a, p_b] = points(pair_gap, pair_gap.at(scene.t));
    const Vector3d r = p_a - p_b + gap * n;
    b.position = a.position_at(scene.t) + r - (scene.t - b.time) * b.velocity;
    for (double& x : b.position) x -= scene.box * std::floor(x / scene.box);
  };
  place();
  const auto pair_gap = gap_of(Image(a, b, scene));
  const auto state = pair_gap.at(scene.t);
  const auto e = pair_gap.evaluate(state, n);
  double K = std::pow(pair_gap.speed(), 2) / pair_gap.size();
  if constexpr (requires { pair_gap.certificate(state, e, n).curvature(0); })
    K = pair_gap.certificate(state, e, n).curvature(0);
  const double natural = std::sqrt(2 * gap * std::abs(K));  // the rate with which the gap just closes, or just does not
  double wanted = 0;
  const double kind = random.uniform();
  if (kind < 0.4) {
    wanted = -log_uniform(random, 1e-3, 1) * pair_gap.speed();
  } else if (kind < 0.6) {
    wanted = -log_uniform(random, 1e-9, 1e-3) * pair_gap.speed();
  } else if (kind < 0.9) {
    wanted = -natural * (1 + signed_log_uniform(random, 1e-5, 1));
  } else {
    wanted = natural * log_uniform(random, 1e-3, 10);
  }
  b.velocity += (wanted - pair_gap.rate(state, e, n)) * n;
  place();
}

void set_path(Random& random, const Scene& scene, double speed, AxisMotion& m) {
  m.time = scene.now * random.uniform();
  m.velocity = speed * random.normal3();
  m.position = scene.box * Vector3d(random.uniform(), random.uniform(), random.uniform());
}
void set_path(Random& random, const Scene& scene, double speed, RigidMotion& m) {
  m.time = scene.now * random.uniform();
  m.velocity = speed * random.normal3();
  m.position = scene.box * Vector3d(random.uniform(), random.uniform(), random.uniform());
}

/// Draws the speed of a pair, and t: fast pairs do not get far between now and t.
double draw_speed(Random& random, double size, Scene& scene) {
  const double speed = log_uniform(random, 1e-2, 1e2);
  scene.t += random.uniform() * std::min(0.2, 0.05 * size / speed);
  return speed;
}

struct SpheroidKind {
  double a, b;

  static SpheroidKind draw(Random& random) {
    const double ratio = std::exp(signed_log_uniform(random, 1e-2, std::log(100)));
    const double b = log_uniform(random, 0.3, 3) / std::cbrt(ratio);
    return {ratio * b, b};
  }
  double bounding_radius() const { return std::max(a, b); }
};

/// Draws a normal along any direction, or the flat or the long side of the body with axis u.
Vector3d draw_normal(Random& random, const Vector3d& u) {
  const double kind = random.uniform();
  const Vector3d any = random.direction();
  if (kind < 0.4) return any;
  const double tilt = log_uniform(random, 1e-9, 1e-1);
  if (kind < 0.7) return (u + tilt * any).normalized();
  const Vector3d across = random.direction().cross(u).normalized();
  return (across + tilt * any).normalized();
}

template <bool kSpin>
void try_spheroids(Random& random, bool search, Tally& tally) {
  const SpheroidKind kind_a = SpheroidKind::draw(random);
  const SpheroidKind kind_b = random.uniform() < 0.5 ? kind_a : SpheroidKind::draw(random);
  const Spheroid A(kind_a.a, kind_a.b);
  const Spheroid B(kind_b.a, kind_b.b);
  const double reach = kind_a.bounding_radius() + kind_b.bounding_radius();
  Scene scene(random, reach);
  const double speed = draw_speed(random, reach, scene);
  const auto motion = [&] {
    AxisMotion m;
    BodyFrame frame;
    set_path(random, scene, speed, m);
    const Vector3d u = random.direction();
    const Vector3d w = (log_uniform(random, 1e-3, 3) * speed / reach) * random.normal3();
    frame.spin = random.normal() * w.norm();
    set_rotation({.mass = 1, .perpendicular = 1, .axial = log_uniform(random, 0.05, 2), .spins = kSpin}, u,
                 w - w.dot(u) * u, m, frame);
    return m;
  };
  AxisMotion a = motion();
  AxisMotion b = motion();
  const auto gap_of = [&](const Image& image) { return UniaxialGap<kSpin>(A, a, B, b, image.r_now, scene.now, reach); };
  const Vector3d n = draw_normal(random, a.axis_at(scene.t));
  const auto points = [&](const auto& /*pair_gap*/, const auto& state) {
    return std::pair<Vector3d, Vector3d>(support_point(A, state.u_a, n), -support_point(B, state.u_b, n));
  };
  arrange(random, scene, n, reach * log_uniform(random, 1e-14, 1e-12), a, b, gap_of, points);
  const Image image(a, b, scene);
  const ExactPair<quad::ExactSpheroid> exact{
      {kind_a.a, kind_a.b, a}, {kind_b.a, kind_b.b, b}, ExactPath::of(a), ExactPath::of(b), image.shift};
  judge(gap_of(image), exact, scene.t, n, tally);
  if (search) judge_search(gap_of(image), exact, scene.t, n, tally);
}

/// A body with two equal moments of inertia, about z; or with three different ones.
struct Top {
  Vector3d inertia, omega;
  Eigen::Matrix3d R;

  static Top symmetric(Random& random, double rate) {
    const double perpendicular = log_uniform(random, 0.3, 3);
    const double axial = random.uniform() < 0.2 ? perpendicular : perpendicular * (0.2 + 1.6 * random.uniform());
    return {{perpendicular, perpendicular, axial}, rate * random.normal3(), random.rotation()};
  }
  static Top asymmetric(Random& random, double rate) {
    const Vector3d squares(log_uniform(random, 0.1, 1), log_uniform(random, 0.1, 1), log_uniform(random, 0.1, 1));
    return {Vector3d::Constant(squares.sum()) - squares, rate * random.normal3(), random.rotation()};
  }
  FreeTop free() const { return {inertia, R, omega}; }
  template <class ExactTop>
  ExactTop exact(double time) const {
    return {inertia, R, omega, time};
  }
};

RigidMotion draw_motion(Random& random, const Scene& scene, double speed, const Top& top) {
  RigidMotion m;
  set_path(random, scene, speed, m);
  m.top = top.free();
  return m;
}

/// Two tops that fly past each other.
struct Flights {
  Scene scene;
  Top top_a, top_b;
  RigidMotion a, b;

  template <class DrawTop>
  Flights(Random& random, double reach, const DrawTop& draw_top) : scene(random, reach) {
    const double speed = draw_speed(random, reach, scene);
    const double rate = log_uniform(random, 1e-3, 3) * speed / reach;
    top_a = draw_top(random, rate);
    top_b = draw_top(random, rate);
    a = draw_motion(random, scene, speed, top_a);
    b = draw_motion(random, scene, speed, top_b);
  }
};

geom::Superellipsoid draw_superellipsoid(Random& random, double length) {
  constexpr std::array kExponents{0.25, 0.3, 0.5, 0.7, 1.0, 1.3, 1.5, 1.6};
  const auto exponent = [&] {
    return kExponents[static_cast<std::size_t>(random.uniform() * static_cast<double>(kExponents.size()))];
  };
  const Vector3d axes(log_uniform(random, 0.5, 2), log_uniform(random, 0.5, 2), log_uniform(random, 0.5, 2));
  return {length * axes, exponent(), exponent()};
}

template <class ExactTop, class DrawTop>
void try_superellipsoids(Random& random, const DrawTop& draw_top, bool search, Tally& tally) {
  using Exact = quad::ExactSuperellipsoid<ExactTop>;
  const double length = log_uniform(random, 2e-3, 500);  // the powers are made of logarithms
  const geom::Superellipsoid A = draw_superellipsoid(random, length);
  const geom::Superellipsoid B = draw_superellipsoid(random, length);
  const NormBodyShape norm_a = norm_body(A).value();
  const NormBodyShape norm_b = norm_body(B).value();
  const double reach = norm_a.bounding_radius + norm_b.bounding_radius;
  Flights flights(random, reach, draw_top);
  Scene& scene = flights.scene;
  RigidMotion& a = flights.a;
  RigidMotion& b = flights.b;
  const auto gap_of = [&](const Image& image) { return SupportGap(norm_a, a, norm_b, b, image.r_now, scene.now); };
  const Vector3d n = random.direction();
  const auto points = [&](const auto& /*pair_gap*/, const auto& state) {
    const auto support = state.pair.bodies().support(n);
    return std::pair<Vector3d, Vector3d>(support.point.a(), support.point.b());
  };
  arrange(random, scene, n, reach * log_uniform(random, 1e-14, 1e-12), a, b, gap_of, points);
  const Image image(a, b, scene);
  const ExactPair<Exact> exact{Exact(A.semi_axes(), A.e1(), A.e2(), flights.top_a.exact<ExactTop>(a.time)),
                               Exact(B.semi_axes(), B.e1(), B.e2(), flights.top_b.exact<ExactTop>(b.time)),
                               ExactPath::of(a), ExactPath::of(b), image.shift};
  judge(gap_of(image), exact, scene.t, n, tally);
  if (search) judge_search(gap_of(image), exact, scene.t, n, tally);
}

void try_spherocylinders(Random& random, bool search, Tally& tally) {
  const geom_test::Spherocylinder rod{log_uniform(random, 0.1, 3), log_uniform(random, 0.1, 1)};
  const double volume = std::numbers::pi * rod.radius * rod.radius * (2 * rod.half_length + 4 * rod.radius / 3);
  const ConvexBody shape(CustomShape(rod, {"spherocylinder", volume, 2, true}));
  const double reach = 2 * rod.bounding_radius();
  Flights flights(random, reach, Top::symmetric);
  Scene& scene = flights.scene;
  RigidMotion& a = flights.a;
  RigidMotion& b = flights.b;
  const auto gap_of = [&](const Image& image) { return ConvexGap(shape, a, shape, b, image.r_now, scene.now); };
  const Vector3d n = random.direction();
  const auto points = [&](const auto& pair_gap, const auto& state) {
    const auto gap = pair_gap.sample(state, n);
    return std::pair<Vector3d, Vector3d>(gap.point_a + rod.radius * n, gap.point_b - rod.radius * n);
  };
  arrange(random, scene, n, reach * log_uniform(random, 1e-14, 1e-12), a, b, gap_of, points);
  const Image image(a, b, scene);
  const ExactPair<quad::ExactSpherocylinder> exact{
      {rod.half_length, rod.radius, flights.top_a.exact<quad::ExactSymmetricTop>(a.time)},
      {rod.half_length, rod.radius, flights.top_b.exact<quad::ExactSymmetricTop>(b.time)},
      ExactPath::of(a),
      ExactPath::of(b),
      image.shift};
  judge(gap_of(image), exact, scene.t, n, tally);
  if (search) judge_search(gap_of(image), exact, scene.t, n, tally);
}

template <class Try>
Tally run(const char* what, std::uint64_t seed, int states, const Try& try_one) {
  Random random(seed);
  Tally tally;
  for (int k = 0; k < states; ++k) try_one(random, k % 10 == 0, tally);
  std::printf(
      "%s: %ld states, %ld touching; stepped over %ld, without the terms %ld; largest errors of g, g', K in "
      "units of their bounds %.3f %.3f %.1e; %ld searches ended on contacts, %ld clear, %ld too deep\n",
      what, tally.states, tally.touching, tally.stepped_over, tally.without_terms, tally.gap, tally.rate,
      tally.curvature, tally.contacts, tally.clear, tally.sunk);
  return tally;
}

void expect_certified(const Tally& tally) {
  EXPECT_EQ(tally.stepped_over, 0);
  EXPECT_EQ(tally.not_apart, 0);
  EXPECT_EQ(tally.sunk, 0);
  EXPECT_LE(tally.gap, 1);
  EXPECT_LE(tally.rate, 1);
  EXPECT_LE(tally.curvature, 1);
  // The states are such that rounding decides.
  EXPECT_GT(tally.without_terms, tally.states / 100);
  EXPECT_LT(2 * tally.touching, tally.states);
  EXPECT_GT(tally.contacts, 0);
  EXPECT_GT(tally.clear, 0);
}

TEST(Rounding, BodiesOfRevolutionWithoutSpin) {
  expect_certified(run("without spin", 1, finder_test::scaled(8000, 400'000), try_spheroids<false>));
}

TEST(Rounding, BodiesOfRevolutionWithSpin) {
  expect_certified(run("with spin", 2, finder_test::scaled(8000, 400'000), try_spheroids<true>));
}

TEST(Rounding, SuperellipsoidsAndTriaxialEllipsoids) {
  expect_certified(
      run("superellipsoids", 3, finder_test::scaled(3000, 150'000), [](Random& random, bool search, Tally& tally) {
        try_superellipsoids<quad::ExactSymmetricTop>(random, Top::symmetric, search, tally);
      }));
}

TEST(Rounding, BodiesWithThreeDifferentMoments) {
  // Exact tops of this kind take half a second a state.
  expect_certified(
      run("asymmetric tops", 6, finder_test::scaled(60, 20'000), [](Random& random, bool search, Tally& tally) {
        try_superellipsoids<quad::ExactAsymmetricTop>(random, Top::asymmetric, search, tally);
      }));
}

TEST(Rounding, UsersShapes) {
  expect_certified(run("spherocylinders", 4, finder_test::scaled(1000, 50'000), try_spherocylinders));
}

/// The judge itself: quadruple against double precision, and against what is known exactly.
TEST(Rounding, QuadruplePrecisionIsThat) {
  const auto tiny = [](Quad x) { return static_cast<double>(quad::abs(x)); };
  EXPECT_LE(tiny(quad::sqrt(Quad(2)) * quad::sqrt(Quad(2)) - 2), 1e-32);
  EXPECT_LE(tiny(quad::cbrt(Quad(2)) * quad::cbrt(Quad(2)) * quad::cbrt(Quad(2)) - 2), 1e-32);
  Random random(5);
  for (int k = 0; k < 1000; ++k) {
    const Quad x = signed_log_uniform(random, 1e-6, 300);
    const quad::SinCos one = quad::sincos(x);
    const quad::SinCos two = quad::sincos(2 * x);
    EXPECT_LE(tiny(one.sin - std::sin(static_cast<double>(x))), 2e-16);
    EXPECT_LE(tiny(one.cos - std::cos(static_cast<double>(x))), 2e-16);
    EXPECT_LE(tiny(quad::exp(x / 10) * quad::exp(-x / 10) - 1), 1e-30);
    EXPECT_LE(tiny(quad::log(quad::exp(x / 10)) - x / 10), 1e-30);
    EXPECT_LE(tiny(quad::exp(x / 10) / std::exp(static_cast<double>(x / 10)) - 1), 1e-14);
    EXPECT_LE(tiny(2 * one.sin * one.cos - two.sin), 1e-30);
    EXPECT_LE(tiny(one.cos * one.cos - one.sin * one.sin - two.cos), 1e-30);
  }
}

TEST(Rounding, ExactTopsAgree) {
  Random random(8);
  for (int k = 0; k < 100; ++k) {
    const Top top = Top::symmetric(random, 2);
    const auto one = top.exact<quad::ExactSymmetricTop>(0.1);
    const auto other = top.exact<quad::ExactAsymmetricTop>(0.1);
    const quad::Quad3 n(random.direction());
    for (const double t : {0.1, 0.3, 4.0, 1.0}) {  // back again too
      for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        EXPECT_LE(static_cast<double>(quad::abs(one.seen(t, n)[i] - other.seen(t, n)[i])), 1e-28);
      }
    }
  }
}

}  // namespace
}  // namespace ed::internal
