#pragma once

/// Flights of two convex bodies, judged by conservative advancement, which shares with a contact finder nothing but
/// libgeom's distance and the free motion: its steps are the distance over a bound of its rate. Faces on faces, edges
/// on edges and vertices on faces included; half of the flights graze. HARDBODY_FULL=1: 100,000 pairs of each kind.

#include <common/full_form.h>
#include <common/geom/random.h>

#include <contact/certified.h>
#include <contact/convex/gap.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace finder_test {

using ed::CustomShape;
using ed::internal::ConvexBody;
using ed::internal::ConvexGap;
using ed::internal::FinderCounters;
using ed::internal::Finding;
using ed::internal::FreeTop;
using ed::internal::Outcome;
using ed::internal::RigidMotion;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;

inline constexpr double kEnd = 3;
inline constexpr double kSeen = 1e-12;     // overlaps below this, in units of the size, are rounding
inline constexpr double kShortest = 1e-5;  // the least step of the reference, in units of size over the largest rate
inline constexpr double kGrazing = 1e-2;   // normal velocity below this share of the relative one

/// Shape with moments of inertia and some directions to its faces, edges or vertices.
struct TestBody {
  std::string kind;
  ConvexBody body;
  ConvexBody exact;  ///< body whose distances the reference asks for
  Vector3d inertia;
  std::vector<Vector3d> directions;
  bool spins = true;  ///< whether it may turn about z
};

template <class Shape>
TestBody test_body(const std::string& kind, const Shape& shape, double volume, const Vector3d& inertia,
                   std::vector<Vector3d> directions) {
  CustomShape::Properties properties;
  properties.name = kind;
  properties.volume = volume;
  const ConvexBody body{CustomShape(shape, properties)};
  return {kind, body, body, inertia, std::move(directions)};
}

inline TestBody sphere(Random& random) {
  const geom::Sphere s(random.uniform(0.2, 1));
  return test_body("sphere", s, s.volume(), s.inertia(1), {Vector3d::UnitZ()});
}

inline TestBody capsule(Random& random) {
  const geom::Capsule s(random.log_uniform(0.1, 3), random.uniform(0.2, 1));
  return test_body("capsule", s, s.volume(), s.inertia(1), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

/// Two bodies in flight.
struct Flight {
  TestBody shape_a, shape_b;
  RigidMotion a, b;
  mutable long declined = 0;

  double size() const { return shape_a.body.bounding_radius + shape_b.body.bounding_radius; }
  geom::DistanceResult distance_result(double t) const { return distance_of(shape_a.exact, shape_b.exact, t); }
  /// Returns the answer that a contact finder has, of users' shapes by their support functions.
  geom::DistanceResult finders_result(double t) const { return distance_of(shape_a.body, shape_b.body, t); }
  geom::DistanceResult distance_of(const ConvexBody& A, const ConvexBody& B, double t) const {
    const geom::Pose X_WA(a.top.at(t).R, a.position_at(t));
    const geom::Pose X_WB(b.top.at(t).R, b.position_at(t));
    return ed::distance(A.shape, X_WA, B.shape, X_WB);
  }
  /// Returns the distance; 0 where libgeom declines.
  double distance(double t) const {
    const geom::DistanceResult result = distance_result(t);
    const double d = result.distance;
    if (std::isnan(d)) ++declined;
    // Only a certain overlap is one: where a smooth body meets an edge, the bound may be 1e-9 of the size.
    return std::isnan(d) ? 0 : d < 0 && result.error_bound < 1 ? std::min(0.0, d + result.error_bound) : d;
  }
  double rate() const {
    return (b.velocity - a.velocity).norm() + shape_a.body.bounding_radius * a.top.max_omega() +
           shape_b.body.bounding_radius * b.top.max_omega();
  }
};

/// Returns a rotation that takes the unit vector u to n.
inline Matrix3d turned_to(const Vector3d& u, const Vector3d& n, Random& random) {
  const Matrix3d to = Eigen::Quaterniond::FromTwoVectors(u, n).toRotationMatrix();
  const double angle = random.coin() ? 0 : random.uniform(0, 6);
  return Eigen::AngleAxisd(angle, n).toRotationMatrix() * to;
}

inline Matrix3d orientation(const TestBody& body, const Vector3d& n, Random& random) {
  if (random.uniform() < 0.4) return random.pose(0).rotation();
  const auto k = static_cast<std::size_t>(random.uniform() * static_cast<double>(body.directions.size()));
  const Matrix3d R = turned_to(body.directions[k].normalized(), n, random);
  if (random.coin()) return R;
  return Eigen::AngleAxisd(random.log_uniform(1e-8, 0.3), random.direction()).toRotationMatrix() * R;
}

/// Draws bodies near each other; half of them have a small relative velocity along the normal.
inline Flight random_flight(Random& random, const TestBody& A, const TestBody& B) {
  const Vector3d n = random.direction();
  Flight f{A, B, {}, {}, 0};
  const Matrix3d R_a = orientation(A, n, random);
  const Matrix3d R_b = orientation(B, -n, random);
  const bool grazes = random.uniform() < 0.7;
  const double slow = random.log_uniform(1e-4, 3e-2);
  const double gap = (grazes ? slow * slow * random.log_uniform(1e-3, 2) : random.log_uniform(1e-6, 1)) * f.size();
  const geom::Support s_a = support(A.body.shape, R_a.transpose() * n);
  const geom::Support s_b = support(B.body.shape, R_b.transpose() * -n);
  // Support points opposite each other, or centres, or anything between.
  const double share = random.coin() ? 1 : random.uniform();
  Vector3d r = share * (R_a * s_a.point - R_b * s_b.point);
  r += (s_a.height + s_b.height + gap - n.dot(r)) * n;
  const double turning = random.coin() ? 1.0 : random.log_uniform(1e-3, 1);
  const auto spin = [&](const Matrix3d& R, const TestBody& body) {
    Vector3d w = random.uniform(0.2, 2) * random.direction().cwiseQuotient(body.inertia.cwiseSqrt());
    if (!body.spins) w.z() = 0;
    return Vector3d(turning * (R * w));
  };
  f.a.top = FreeTop(A.inertia, R_a, spin(R_a, A));
  f.b.top = FreeTop(B.inertia, R_b, spin(R_b, B));
  f.b.position = r;
  Vector3d v = random.uniform(0.2, 3) * random.direction();
  if (grazes) {
    const Vector3d relative =
        v + f.b.top.at(0).omega.cross(R_b * s_b.point) - f.a.top.at(0).omega.cross(R_a * s_a.point);
    v += (random.coin() ? slow : -slow) * n - relative.dot(n) * n;
  }
  f.b.velocity = v;
  return f;
}

/// Returns a time at which the bodies overlap by more than kSeen, or infinity: steps of the distance over its largest
/// rate, no shorter than kShortest, and where three of those show a minimum, golden sections of it.
inline double reference(const Flight& f) {
  const double rate = f.rate();
  const double overlap = -kSeen * f.size();
  const double shortest = kShortest * f.size() / rate;
  std::array<double, 3> t{0, 0, 0}, d{0, 0, f.distance(0)};
  int steps = 0;
  while (t[2] < kEnd) {
    t = {t[1], t[2], t[2] + std::max(0.999 * d[2] / rate, shortest)};
    d = {d[1], d[2], f.distance(t[2])};
    if (d[2] < overlap) return t[2];
    if (++steps < 2 || !(d[1] <= d[0] && d[1] <= d[2] && d[1] < 4 * rate * shortest)) continue;
    double low = t[0], high = t[2];
    for (int k = 0; k < 40; ++k) {
      const double m = low + 0.381966 * (high - low), p = high - 0.381966 * (high - low);
      if (f.distance(m) < f.distance(p)) {
        high = p;
      } else {
        low = m;
      }
    }
    if (f.distance(low) < overlap) return low;
  }
  return std::numeric_limits<double>::infinity();
}

struct Tally {
  long pairs = 0, contacts = 0, grazing = 0, missed = 0, late = 0, wrong = 0, early = 0, unanswered = 0, declined = 0;
  double evaluations = 0;
};

class FlightGap : public ConvexGap {
 public:
  explicit FlightGap(const Flight& f)
      : ConvexGap(f.shape_a.body, f.a, f.shape_b.body, f.b, f.b.position - f.a.position, 0) {}
};

template <class PairGap>
void judge(const Flight& f, Tally& tally, FinderCounters& count) {
  const PairGap gap(f);
  Vector3d n = Vector3d::Zero();
  const Finding found = certified_contact(gap, 0, kEnd, 100000, n, count);
  const double wanted = reference(f);
  ++tally.pairs;
  if (found.outcome == Outcome::bound || found.outcome == Outcome::declined) ++tally.unanswered;
  if (found.outcome == Outcome::overlapping) ++tally.missed;
  if (found.outcome == Outcome::clear && wanted < kEnd) ++tally.missed;
  if (found.outcome != Outcome::contact) return;
  ++tally.contacts;
  if (wanted < found.time - 1e-12) ++tally.late;
  // Where a smooth body meets an edge or a face, or a user's shape a rim, libgeom certifies distances to no more than
  // its error bound.
  const geom::DistanceResult at = f.distance_result(found.time);
  // Of polyhedra that touch to the last bit, libgeom declines some: judged a little before.
  const double declined = std::isnan(at.distance) ? 1e-10 / f.rate() : 0;
  const double distance = declined > 0 ? f.distance(found.time - declined) : at.distance;
  // Of libgeom's own kinds with edges the points found are the contact; that another normal may have a larger gap,
  // which the bound of an overlap says, is no excuse.
  const bool cores = f.shape_a.body.core && f.shape_b.body.core;
  const double of_finder = f.finders_result(found.time).error_bound;
  const double bound = cores                   ? at.residual
                       : std::isnan(of_finder) ? at.error_bound
                                               : std::max(at.error_bound, of_finder);
  const double allowed = 1e-12 * f.size() + (declined > 0 ? 1e-10 : bound);
  if (!(std::abs(distance) <= allowed)) ++tally.wrong;
  constexpr double h = 1e-5;
  const double rate = (f.distance(found.time + h) - f.distance(found.time - h)) / (2 * h);
  if (std::abs(rate) < kGrazing * (f.b.velocity - f.a.velocity).norm()) ++tally.grazing;
  // A touch that is too shallow for the reference counts, if the distance says so.
  if (!(wanted < kEnd) && found.time < 0.9 * kEnd) ++tally.early;
  tally.declined += f.declined > 0 ? 1 : 0;
}

using Draw = std::function<TestBody(Random&)>;

template <class PairGap = FlightGap>
Tally search(const char* name, const Draw& a, const Draw& b) {
  Random random(1);
  Tally tally;
  FinderCounters count;
  const long pairs = full_form() ? 100000 : 1000;
  while (tally.pairs < pairs) judge<PairGap>(random_flight(random, a(random), b(random)), tally, count);
  tally.evaluations = static_cast<double>(count.evaluations);
  std::printf(
      "%s: %ld pairs, %ld contacts, %ld grazing: %ld missed, %ld late, %ld wrong, %ld unanswered; %ld shallower than "
      "the reference sees; %ld declined by libgeom; %.2f points in time and %.2f of Newton's method a search, %llu "
      "rescues\n",
      name, tally.pairs, tally.contacts, tally.grazing, tally.missed, tally.late, tally.wrong, tally.unanswered,
      tally.early, tally.declined, static_cast<double>(count.evaluations) / static_cast<double>(count.predictions),
      static_cast<double>(count.newton_evaluations) / static_cast<double>(count.predictions),
      static_cast<unsigned long long>(count.rescues));
  return tally;
}

/// Evaluations at points in time that searches take on average; of rims that do not roll it is 100.
inline constexpr double kFewEvaluations = 15;

inline void expect_none_missed(const Tally& tally) {
  EXPECT_LE(tally.evaluations, kFewEvaluations * static_cast<double>(tally.pairs));
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.late, 0);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_EQ(tally.unanswered, 0);
  EXPECT_GT(tally.contacts * 5, tally.pairs);
  EXPECT_GT(tally.grazing * 10, tally.contacts);
  EXPECT_LE(tally.early * 50, tally.contacts);
  EXPECT_LE(tally.declined * 100, tally.contacts);
}

}  // namespace finder_test
