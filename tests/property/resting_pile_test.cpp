/// Eight cube-like superellipsoids, or cubes, in a pile on a floor, in a small engine of sequential impulses: with
/// contact patches they come to rest. One point a contact, that of the distance, jumps across faces, and the pile
/// rocks.

#include <common/full_form.h>

#include <geom/contact_patch.h>
#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <tuple>
#include <vector>

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::Pose;

constexpr double kStep = 1.0 / 120;
constexpr double kGravity = 9.81;
constexpr double kFriction = 0.5;
constexpr double kWithin = 2e-3;     ///< gap at which surfaces are in contact
constexpr double kSlop = 1e-4;       ///< depth that is left
constexpr double kCorrection = 0.2;  ///< share of further depth that a step takes away
constexpr int kSweeps = 30;

struct Body {
  Pose X;
  Vector3d velocity = Vector3d::Zero(), omega = Vector3d::Zero();
  double inverse_mass = 1;
  Matrix3d inverse_inertia = Matrix3d::Zero();  ///< world frame
};

/// Point of a contact between A (-1: the floor) and B, normal from A to B.
struct Point {
  int a, b;
  std::uint64_t id;
  Vector3d arm_a, arm_b, normal;
  double depth;
  double impulse = 0;                    ///< impulse along the normal
  Vector3d friction = Vector3d::Zero();  ///< impulse across it
};

/// Points of a contact, and their depths.
enum class Contacts {
  distance,             ///< points of the distance
  patch,                ///< corners of the patch, all with the depth of the deepest place
  corners,              ///< corners of the patch with their own depths
  corners_and_deepest,  ///< corners with their own depths, and the points of the distance
};

template <class Shape>
class Pile {
 public:
  /// `disturbance`: factor of the first tilts and velocities.
  Pile(const Shape& shape, Contacts kind, double disturbance = 1) : kind_(kind), shape_(shape) {
    const Vector3d inertia = shape_.inertia(1);
    for (int k = 0; k < 8; ++k) {
      const double x = (k & 1) == 0 ? -0.52 : 0.52, y = (k & 2) == 0 ? -0.52 : 0.52, z = (k & 4) == 0 ? 0.5005 : 1.502;
      Body body;
      const double tilt = 1e-3 * disturbance * (k - 3.5);
      body.X = Pose(Eigen::AngleAxisd(tilt, Vector3d(1, 0.3 * k, 0).normalized()).toRotationMatrix(),
                    Vector3d(x + 0.01 * (k % 3), y, z));
      body.velocity = 0.02 * disturbance * Vector3d(std::sin(k), std::cos(3 * k), std::sin(2 * k));
      body.omega = 0.05 * disturbance * Vector3d(std::cos(k), std::sin(5 * k), std::sin(k));
      bodies_.push_back(body);
    }
    moments_ = inertia.cwiseInverse().asDiagonal();
  }

  void step() {
    for (Body& body : bodies_) {
      body.velocity.z() -= kGravity * kStep;
      const Matrix3d& R = body.X.rotation();
      body.inverse_inertia = R * moments_ * R.transpose();
    }
    std::vector<Point> points = contacts();
    for (Point& p : points) warm_start(p);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (Point& p : points) solve(p);
    }
    impulses_.clear();
    for (const Point& p : points) impulses_[{p.a, p.b, p.id}] = {p.impulse, p.friction};
    for (Body& body : bodies_) {
      const double turn = body.omega.norm() * kStep;
      const Matrix3d R =
          turn > 0 ? Matrix3d(Eigen::AngleAxisd(turn, body.omega.normalized()).toRotationMatrix() * body.X.rotation())
                   : body.X.rotation();
      body.X = Pose::nearest_rotation(R, body.X.position() + kStep * body.velocity);
    }
  }

  double kinetic_energy() const {
    double energy = 0;
    for (const Body& body : bodies_) {
      energy += 0.5 * body.velocity.squaredNorm() + 0.5 * body.omega.dot(body.inverse_inertia.inverse() * body.omega);
    }
    return energy;
  }

  double lowest() const {
    double z = 1e9;
    for (const Body& body : bodies_) z = std::min(z, body.X.position().z());
    return z;
  }
  double largest_tilt() const {
    double tilt = 0;
    for (const Body& body : bodies_) {
      // The axis that is nearest to the vertical.
      tilt = std::max(tilt, std::acos(std::min(1.0, body.X.rotation().row(2).cwiseAbs().maxCoeff())));
    }
    return tilt;
  }

 private:
  std::vector<Point> contacts() const {
    std::vector<Point> points;
    for (int b = 0; b < 8; ++b) {
      touch(points, -1, b, floor_, Pose());
      for (int a = 0; a < b; ++a) {
        const Vector3d way = bodies_[std::size_t(b)].X.position() - bodies_[std::size_t(a)].X.position();
        if (way.norm() < 2 * shape_.bounding_radius() + kWithin) touch(points, a, b, shape_, bodies_[std::size_t(a)].X);
      }
    }
    return points;
  }

  template <class A>
  void touch(std::vector<Point>& points, int a, int b, const A& shape_a, const Pose& X_A) const {
    const Pose& X_B = bodies_[std::size_t(b)].X;
    const geom::DistanceResult at = geom::distance(shape_a, X_A, shape_, X_B);
    if (!(at.distance <= kWithin)) return;
    const auto add = [&](std::uint64_t id, const Vector3d& p_a, const Vector3d& p_b, double depth) {
      const Vector3d middle = 0.5 * (p_a + p_b);
      points.push_back({a, b, id, middle - X_A.position(), middle - X_B.position(), at.normal, depth});
    };
    if (kind_ == Contacts::distance) {
      add(0, at.point_a, at.point_b, -at.distance);
      return;
    }
    const geom::ContactPatch patch =
        geom::contact_patch(shape_a, X_A, shape_, X_B, at, {.within = kWithin, .tolerance = 0.05});
    // At the corners of a curved face the surfaces are kWithin apart: all count with the depth of the deepest place.
    const bool own = kind_ != Contacts::patch;
    if (kind_ == Contacts::corners_and_deepest) add(0, at.point_a, at.point_b, -at.distance);
    for (const geom::PatchPoint& p : patch.points) add(p.id, p.point_a, p.point_b, own ? p.depth : -at.distance);
  }

  Vector3d rate(const Point& p) const {
    const Body& b = bodies_[std::size_t(p.b)];
    Vector3d v = b.velocity + b.omega.cross(p.arm_b);
    if (p.a >= 0) v -= bodies_[std::size_t(p.a)].velocity + bodies_[std::size_t(p.a)].omega.cross(p.arm_a);
    return v;
  }

  void push(const Point& p, const Vector3d& impulse) {
    Body& b = bodies_[std::size_t(p.b)];
    b.velocity += b.inverse_mass * impulse;
    b.omega += b.inverse_inertia * p.arm_b.cross(impulse);
    if (p.a < 0) return;
    Body& a = bodies_[std::size_t(p.a)];
    a.velocity -= a.inverse_mass * impulse;
    a.omega -= a.inverse_inertia * p.arm_a.cross(impulse);
  }

  double mass_along(const Point& p, const Vector3d& n) const {
    const auto part = [&](const Body& body, const Vector3d& arm) {
      const Vector3d turn = arm.cross(n);
      return body.inverse_mass + turn.dot(body.inverse_inertia * turn);
    };
    return 1 / (part(bodies_[std::size_t(p.b)], p.arm_b) + (p.a < 0 ? 0 : part(bodies_[std::size_t(p.a)], p.arm_a)));
  }

  void warm_start(Point& p) {
    const auto known = impulses_.find({p.a, p.b, p.id});
    if (known == impulses_.end()) return;
    p.impulse = known->second.first;
    p.friction = known->second.second - known->second.second.dot(p.normal) * p.normal;
    push(p, p.impulse * p.normal + p.friction);
  }

  void solve(Point& p) {
    const double wanted = p.depth < 0 ? p.depth / kStep : kCorrection / kStep * std::max(0.0, p.depth - kSlop);
    const double change = mass_along(p, p.normal) * (wanted - rate(p).dot(p.normal));
    const double impulse = std::max(0.0, p.impulse + change);
    push(p, (impulse - p.impulse) * p.normal);
    p.impulse = impulse;
    Vector3d slip = rate(p);
    slip -= slip.dot(p.normal) * p.normal;
    const double speed = slip.norm();
    if (!(speed > 0)) return;
    Vector3d friction = p.friction - mass_along(p, slip / speed) * slip;
    const double most = kFriction * p.impulse;
    if (friction.norm() > most) friction *= most / friction.norm();
    push(p, friction - p.friction);
    p.friction = friction;
  }

  Contacts kind_;
  Shape shape_;
  geom::HalfSpace floor_;
  std::vector<Body> bodies_;
  Matrix3d moments_;
  std::map<std::tuple<int, int, std::uint64_t>, std::pair<double, Vector3d>> impulses_;
};

TEST(RestingPile, ComesToRestOnPatches) {
  const geom::Superellipsoid shape({0.5, 0.5, 0.5}, 0.25, 0.25);
  Pile with(shape, Contacts::patch), without(shape, Contacts::distance);
  const int steps = slow_build() ? 60 : 240;
  const double begin = [&] {
    with.step();
    without.step();
    return with.kinetic_energy();
  }();
  double middle = 0;
  for (int k = 1; k < steps; ++k) {
    with.step();
    without.step();
    if (k == steps / 4) middle = with.kinetic_energy();
  }
  std::printf("kinetic energy with patches %.2g, %.2g, %.2g, with points %.2g; tilts %.2g and %.2g\n", begin, middle,
              with.kinetic_energy(), without.kinetic_energy(), with.largest_tilt(), without.largest_tilt());
  EXPECT_LT(with.kinetic_energy(), 1e-6 * begin);
  EXPECT_LT(with.kinetic_energy(), 1e-2 * without.kinetic_energy());
  EXPECT_NEAR(with.lowest(), 0.5, 1e-3);
}

/// Checks that cubes come to rest upright.
void check_cubes(Contacts kind, double disturbance) {
  Pile pile(geom::Box({0.5, 0.5, 0.5}), kind, disturbance);
  pile.step();
  const double begin = pile.kinetic_energy();
  const int steps = slow_build() ? 120 : 480;
  for (int k = 1; k < steps; ++k) pile.step();
  std::printf("kinetic energy of cubes %.2g, %.2g, tilt %.2g\n", begin, pile.kinetic_energy(), pile.largest_tilt());
  EXPECT_LT(pile.kinetic_energy(), 1e-6 * begin);
  EXPECT_LT(pile.largest_tilt(), 1e-3);
  EXPECT_NEAR(pile.lowest(), 0.5, 1e-3);
}

/// Cubes are bounded by walls as steep as they are tilted, on which the surfaces are kWithin apart: the depths are
/// those of the faces nevertheless, and no corner is without support. Cubes that are tilted more, by up to 3.5e-3, have
/// edges whose walls are too wide for that; the deepest place is then one of the contact's points.
TEST(RestingPile, OfCubesComesToRestOnTheDepthsOfCorners) {
  check_cubes(Contacts::corners, 0.1);
  check_cubes(Contacts::corners_and_deepest, 1);
}

}  // namespace
