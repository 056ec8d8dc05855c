// A user's own shapes in motion: spherocylinders, whose distance is known exactly from their segments, and ellipsoids
// of which the finder is told nothing but the support function.

#include <common/ed/all_pairs.h>
#include <common/ed/same_collisions.h>
#include <common/ed/states.h>
#include <common/geom/shapes.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace {

using ed::CustomShape;
using Eigen::Vector3d;
using geom_test::Spherocylinder;
using test_common::message_of;
using testing::HasSubstr;

constexpr double kRodLength = 1.0;  // half of the segment
constexpr double kRodRadius = 0.5;

double rod_volume() {
  return std::numbers::pi * kRodRadius * kRodRadius * (2 * kRodLength + 4 * kRodRadius / 3);
}

CustomShape rod() {
  return {Spherocylinder{kRodLength, kRodRadius}, {"spherocylinder", rod_volume(), 2, true}};
}

ed::Species rods() {
  return {rod(), 1, {0.7, 0.7, 0.12}, true};
}

/// The least distance of two segments p +- L u (Lumelsky, Inf. Process. Lett. 21 (1985) 55): the best of the interior
/// point and the four ends.
double segment_distance(const Vector3d& p, const Vector3d& u, const Vector3d& q, const Vector3d& w, double L) {
  const auto clamp = [L](double x) { return std::clamp(x, -L, L); };
  const Vector3d r = q - p;
  double best = std::numeric_limits<double>::infinity();
  const auto look = [&](double s, double t) { best = std::min(best, (r + t * w - s * u).norm()); };
  const double b = u.dot(w);
  const double D = 1 - b * b;
  if (D > 1e-14) {
    const double s = (r.dot(u) - b * r.dot(w)) / D;
    const double t = (b * r.dot(u) - r.dot(w)) / D;
    if (std::abs(s) <= L && std::abs(t) <= L) look(s, t);
  }
  for (const double end : {-L, L}) {
    look(end, clamp(b * end - r.dot(w)));
    look(clamp(r.dot(u) + b * end), end);
  }
  return best;
}

double rod_distance(const ed::Motion& a, const ed::Motion& b) {
  return segment_distance(a.pose.position(), a.pose.rotation().col(2), b.pose.position(), b.pose.rotation().col(2),
                          kRodLength) -
         2 * kRodRadius;
}

ed::Motion random_motion(ed::Random& random, const Vector3d& position, double speed) {
  ed::Motion motion;
  motion.pose = geom::Pose(random.rotation(), position);
  motion.velocity = speed * random.direction();
  motion.angular_velocity = random.normal3();
  motion.inertia = rods().inertia;
  return motion;
}

/// The first time at which the rods overlap by more than `depth`, by steps of the distance over its largest rate, no
/// shorter than 1e-6.
double first_overlap(const ed::Motion& a, const ed::Motion& b, double end, double depth) {
  const auto fastest = [](const ed::Motion& m) { return m.angular_velocity.norm() * 6 * (kRodLength + kRodRadius); };
  const double rate = (a.velocity - b.velocity).norm() + fastest(a) + fastest(b);
  double t = 0;
  while (t < end) {
    const double d = rod_distance(propagate(a, t), propagate(b, t));
    if (d < -depth) return t;
    t += std::max(std::abs(d) / rate, 1e-6);
  }
  return end;
}

TEST(CustomShape, RodsMeetWhenTheirSegmentsSaySo) {
  ed::Random random(1);
  int hits = 0;
  double worst = 0;
  for (int k = 0; k < 200; ++k) {
    const ed::Motion a = random_motion(random, Vector3d::Zero(), 0.3);
    ed::Motion b = random_motion(random, 3.5 * random.direction(), 0.3);
    b.velocity -= 0.5 * b.pose.position();
    const double end = 4;
    const ed::ContactResult found = time_of_contact(rod(), a, rod(), b, end);
    const double overlap = first_overlap(a, b, end, 1e-9);
    if (found.status == ed::ContactStatus::hit) {
      ++hits;
      const double d = rod_distance(propagate(a, found.time), propagate(b, found.time));
      worst = std::max(worst, std::abs(d));
      ASSERT_LE(std::abs(d), 1e-13) << k;
      ASSERT_GE(overlap, found.time) << k;
      // Both segments are a radius from the point.
      const Vector3d u = propagate(a, found.time).pose.rotation().col(2);
      const Vector3d x = found.point - propagate(a, found.time).pose.position();
      ASSERT_NEAR((x - std::clamp(x.dot(u), -kRodLength, kRodLength) * u).norm(), kRodRadius, 1e-12) << k;
    } else {
      ASSERT_EQ(found.status, ed::ContactStatus::separated) << k;
      ASSERT_EQ(overlap, end) << k;
    }
  }
  std::printf("%d of 200 pairs touch, |distance| <= %.1e there\n", hits, worst);
  EXPECT_GT(hits, 50);
}

/// Returns the least distance of all pairs, by their segments.
double least_distance(const ed::System& system) {
  double least = std::numeric_limits<double>::infinity();
  ed_test::for_each_pair(system, [&](const ed::Body& a, const ed::Body& b, const Vector3d& r) {
    const double d = segment_distance(Vector3d::Zero(), a.rotation.col(2), r, b.rotation.col(2), kRodLength);
    least = std::min(least, d - 2 * kRodRadius);
  });
  return least;
}

TEST(CustomShape, RodsRunInASimulation) {
  ed::StartOptions options;
  options.number = 64;
  options.packing_fraction = 0.25;
  const ed::System start = ed::random_start(rods(), options);
  for (const auto neighbours : {ed::Neighbours::dilated, ed::Neighbours::obp}) {
    ed::SimulationOptions how;
    how.neighbours = neighbours;
    ed::Simulation simulation(start, how);
    const double energy = simulation.kinetic().energy();
    for (int k = 0; k < 10; ++k) {
      simulation.run_collisions(100);
      ASSERT_GE(least_distance(simulation.system()), -1e-12) << k;
    }
    EXPECT_EQ(simulation.counters().overlaps, 0U);
    EXPECT_NEAR(simulation.kinetic().energy() / energy, 1, 1e-12);
  }
}

void expect_sound_runs(const std::vector<ed::Component>& components, const std::vector<ed::Neighbours>& lists,
                       const std::string& what) {
  ed::StartOptions options;
  options.packing_fraction = 0.1;
  const ed::System start = ed::random_start(components, options);
  for (const ed::Neighbours neighbours : lists) {
    ed::SimulationOptions how;
    how.neighbours = neighbours;
    ed::Simulation simulation(start, how);
    const double energy = simulation.kinetic().energy();
    double seconds = 0;
    for (int k = 0; k < 4; ++k) {
      const auto begin = std::chrono::steady_clock::now();
      simulation.run_collisions(25);
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      // At kinks and flat faces distances are known to some 1e-12.
      const ed::Audit audit = ed::audit(simulation.system());
      ASSERT_GE(audit.minimum_distance, -1e-11) << what;
      ASSERT_EQ(audit.unanswered, 0) << what;
    }
    EXPECT_EQ(simulation.counters().overlaps, 0U) << what;
    EXPECT_NEAR(simulation.kinetic().energy() / energy, 1, 1e-12) << what;
    std::printf("%s: %.0f collisions a second\n", what.c_str(), 100 / seconds);
  }
}

TEST(CustomShape, RunsBesideOtherShapesAndWithoutSymmetry) {
  const geom_test::Pear pear{0.7, 0.8, 0.4};
  // The moments need not be those of uniform density; without an axis of revolution the body turns about all three.
  const ed::Species pears{CustomShape(pear, {"pear", 2.5, std::nullopt, false}), 1, {0.5, 0.45, 0.25}, true};
  const ed::Species superballs = ed::uniform_species(geom::Superellipsoid({0.6, 0.6, 0.6}, 0.5, 0.5));
  using ed::Neighbours;
  expect_sound_runs({{rods(), 20}, {superballs, 25}}, {Neighbours::dilated, Neighbours::obp, Neighbours::cells},
                    "rods and superballs");
  // The box is too small for boxes that are not known to be tight.
  expect_sound_runs({{pears, 40}}, {Neighbours::dilated, Neighbours::cells}, "pears");
}

/// Radius of edges that look sharp, and the ball that rolls along them.
constexpr double kEdge = 0.05;

/// A body whose edges are rounded: a sharp one and all that is kEdge from it.
template <class Sharp>
struct Rounded {
  Sharp core;

  geom::Support support(const Vector3d& n) const {
    const geom::Support sharp = core.support(n);
    return {sharp.height + kEdge * n.norm(), sharp.point + kEdge * n.normalized()};
  }
  Eigen::Matrix3d support_hessian(const Vector3d& n) const {
    return core.support_hessian(n) + geom_test::PlainBall{kEdge}.support_hessian(n);
  }
  double bounding_radius() const { return core.bounding_radius() + kEdge; }
  double inscribed_radius() const { return core.inscribed_radius() + kEdge; }
  double min_curvature_radius() const { return kEdge; }
};

struct Box {
  Vector3d half;

  geom::Support support(const Vector3d& n) const {
    const Vector3d corner(std::copysign(half.x(), n.x()), std::copysign(half.y(), n.y()),
                          std::copysign(half.z(), n.z()));
    return {n.dot(corner), corner};
  }
  Eigen::Matrix3d support_hessian(const Vector3d&) const { return Eigen::Matrix3d::Zero(); }
  double bounding_radius() const { return half.norm(); }
  double inscribed_radius() const { return half.minCoeff(); }
};

/// Cylinder about z.
struct Cylinder {
  double half_length;
  double radius;

  geom::Support support(const Vector3d& n) const {
    const double across = std::hypot(n.x(), n.y());
    Vector3d point(0, 0, std::copysign(half_length, n.z()));
    if (across > 0) point.head<2>() = radius / across * n.head<2>();
    return {half_length * std::abs(n.z()) + radius * across, point};
  }
  Eigen::Matrix3d support_hessian(const Vector3d& n) const {
    const double across = std::hypot(n.x(), n.y());
    if (across == 0) return Eigen::Matrix3d::Zero();
    const Vector3d m = Vector3d(-n.y(), n.x(), 0) / across;
    return radius / across * m * m.transpose();
  }
  double bounding_radius() const { return std::hypot(half_length, radius); }
  double inscribed_radius() const { return std::min(half_length, radius); }
};

/// Flat faces and edges of a twentieth of the body's size.
TEST(CustomShape, RunsWithFacesAndNarrowEdges) {
  const Rounded<Box> box{{{0.75, 0.55, 0.45}}};
  // A little more than the core's; nothing that is asserted depends on it, nor on the moments.
  const ed::Species boxes{CustomShape(box, {"box", 1.8, std::nullopt, true}), 1, {0.2, 0.3, 0.32}, true};
  const Rounded<Cylinder> cylinder{{0.65, 0.45}};
  const ed::Species cylinders{CustomShape(cylinder, {"cylinder", 1.05, 2, true}), 1, {0.22, 0.22, 0.12}, true};
  const std::vector<ed::Neighbours> lists = {ed::Neighbours::dilated};
  expect_sound_runs({{boxes, 30}}, lists, "boxes");
  expect_sound_runs({{cylinders, 30}}, lists, "cylinders");
  expect_sound_runs({{boxes, 15}, {cylinders, 15}}, lists, "boxes and cylinders");
}

// Of sharp cubes too the support function is enough: contacts are found as for libgeom's own.
TEST(CustomShape, SharpPolytopesCollideAsKnownOnes) {
  const auto expect_same_collisions = [](const std::string& name, const auto& shape) {
    ed::StartOptions options;
    options.number = 48;
    options.packing_fraction = 0.2;
    ed::System system = ed::random_start(ed::uniform_species(shape), options);
    const auto known = ed_test::first_collisions(system, {}, 250);
    system.species[0].shape =
        CustomShape(geom_test::PlainPolytope<std::decay_t<decltype(shape)>>{shape}, {name, shape.volume(), {}, true});
    ed_test::expect_same(known, ed_test::first_collisions(system, {}, 250), name);
  };
  expect_same_collisions("cubes", geom::Box({0.5, 0.5, 0.5}));
  expect_same_collisions("flat boxes", geom::Box({0.8, 0.5, 0.1}));
  expect_same_collisions("octahedra", geom::ConvexPolyhedron::in_principal_frame(geom::solid_vertices("octahedron")));
}

/// An ellipsoid that tells its support function and radii only.
struct Unknown {
  geom::Ellipsoid shape;

  geom::Support support(const Vector3d& n) const { return shape.support(n); }
  Eigen::Matrix3d support_hessian(const Vector3d& n) const { return shape.support_hessian(n); }
  double bounding_radius() const { return shape.bounding_radius(); }
  double inscribed_radius() const { return shape.inscribed_radius(); }
  double min_curvature_radius() const { return shape.min_curvature_radius(); }
};

TEST(CustomShape, AnUnknownEllipsoidCollidesAsTheKnownOne) {
  ed::System system = ed_test::start({2, 0.35, 100, ed_test::Inertia::uniform, 5});
  const geom::Ellipsoid shape = ed_test::ellipsoid_of(system);
  const auto collisions = [](const ed::System& of) {
    ed::Simulation simulation(of);
    simulation.record_collisions(300);
    simulation.run_collisions(300);
    return simulation.collisions();
  };
  const auto known = collisions(system);
  system.species[0].shape = CustomShape(Unknown{shape}, {"an ellipsoid", shape.volume(), shape.symmetry_axis(), true});
  const auto unknown = collisions(system);
  ASSERT_EQ(known.size(), unknown.size());
  for (std::size_t k = 0; k < known.size(); ++k) {
    ASSERT_EQ(known[k].i, unknown[k].i) << k;
    ASSERT_EQ(known[k].j, unknown[k].j) << k;
    ASSERT_NEAR(known[k].time, unknown[k].time, 1e-9) << k;
  }
}

/// A ball but for a share of x y z where that is positive: along the body's axes nothing shows.
struct Dented : Unknown {
  double height;

  double bounding_radius() const { return 1.2; }
  double inscribed_radius() const { return 0.8; }
  double min_curvature_radius() const { return 0; }

  geom::Support support(const Vector3d& n) const {
    geom::Support s = shape.support(n);
    s.height += height * std::max(0.0, n.x() * n.y() * n.z());
    return s;
  }
};

TEST(CustomShape, RefusesShapesThatAreNone) {
  const auto made = [](double half_length, double radius, double volume, std::optional<int> axis) {
    return message_of([&] { (void)CustomShape(Spherocylinder{half_length, radius}, {"rod", volume, axis, true}); });
  };
  EXPECT_EQ(made(kRodLength, kRodRadius, rod_volume(), 2), "no std::invalid_argument");
  EXPECT_THAT(made(1, 0, 1, 2), HasSubstr("shape rod: inscribed_radius() is 0"));
  EXPECT_THAT(made(std::numeric_limits<double>::infinity(), 1, 1, 2), HasSubstr("bounding_radius() is inf"));
  EXPECT_THAT(made(1, 0.5, 0, 2), HasSubstr("volume is 0"));
  EXPECT_THAT(made(1, 0.5, 1e3, 2), HasSubstr("volume is 1000"));
  EXPECT_THAT(made(1, 0.5, 2, 3), HasSubstr("symmetry_axis is 3; accepted: 0, 1 or 2"));
  EXPECT_THAT(made(1, 0.5, 2, 0), HasSubstr("symmetry_axis is 0; accepted: none: a turn about it changes"));
  constexpr double kBall = 4.18879020478639098;
  // What only directions between the axes show.
  const auto shape = [](const auto& body, std::optional<int> axis, bool symmetric) {
    return message_of([&] { (void)CustomShape(body, {"body", kBall, axis, symmetric}); });
  };
  const Unknown ball{geom::Ellipsoid({1, 1, 1})};
  EXPECT_EQ(shape(ball, 2, true), "no std::invalid_argument");
  EXPECT_THAT(shape(Dented{ball, 2}, std::nullopt, false), HasSubstr("the support height along ("));
  EXPECT_THAT(shape(Dented{ball, -1e-3}, std::nullopt, true), HasSubstr("centrally_symmetric is 1; accepted: false"));
  EXPECT_THAT(shape(Dented{ball, -1e-3}, 2, false), HasSubstr("symmetry_axis is 2; accepted: none"));
}

/// A ball that has no answer where another one comes from.
struct Silent : Unknown {
  geom::Support support(const Vector3d& n) const {
    const Vector3d way = Vector3d(1, 2, 3).normalized();
    geom::Support s = shape.support(n);
    if (std::abs(n.dot(way)) > 0.999 * n.norm()) s.height = std::numeric_limits<double>::quiet_NaN();
    return s;
  }
  double min_curvature_radius() const { return 0; }
};

TEST(CustomShape, PairsWithoutAnAnswerAreCountedAndDumped) {
  const CustomShape silent(Silent{{geom::Ellipsoid({1, 1, 1})}}, {"silent", 4.18879020478639098, std::nullopt, false});
  ed::System system;
  system.species = {ed::Species{silent, 1, {0.4, 0.4, 0.4}, true}};
  system.box = 20;
  system.bodies.resize(2);
  // They meet along that direction, coming from another one.
  const Vector3d way = Vector3d(1, 2, 3).normalized();
  const Vector3d velocity = -std::cos(0.5) * way + std::sin(0.5) * way.unitOrthogonal();
  system.bodies[1].position = 2 * way - 3 * velocity;
  system.bodies[1].velocity = velocity;
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::cells;
  ed::Simulation simulation(system, options);
  simulation.run_until(3.01);
  EXPECT_GT(simulation.counters().declined, 0U);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  ASSERT_FALSE(simulation.failures().empty());
  const ed::FailedPair& failed = simulation.failures().front();
  EXPECT_EQ(failed.reason, ed::FailureReason::declined);
  EXPECT_STREQ(ed::to_string(failed.reason), "no method tells whether the bodies overlap");
  const ed::ContactResult again =
      ed::time_of_contact(failed.shape_i, failed.motion_i, failed.shape_j, failed.motion_j, failed.time + 1);
  EXPECT_EQ(again.status, ed::ContactStatus::failed);
  EXPECT_NEAR(again.time, failed.time, 1e-12);
}

TEST(CustomShape, HasNoEquationsForThePapersSearch) {
  ed::ContactOptions options;
  options.finder = ed::Finder::bracketing;
  const ed::Motion at;
  EXPECT_THAT(message_of([&] { (void)time_of_contact(rod(), at, rod(), at, 1, options); }),
              HasSubstr("shape spherocylinder is a support function; accepted: \"certified\""));
}

}  // namespace
