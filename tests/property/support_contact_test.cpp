// Contact times of superellipsoids against a search that shares nothing with the finder but the distance and the free
// motion: conservative advancement, whose steps are the distance over a bound of its rate. Pairs of five kinds of
// orientation (faces, edges and vertices included), of which many graze, and one in five starts as a collision leaves
// it: in touch, parting. HARDBODY_FULL=1: 100,000 contacts.

#include "common/full_form.h"
#include "common/geom_random.h"
#include "common/geom_superellipsoid_sets.h"

#include <contact/body_shapes.h>
#include <contact/certified.h>
#include <contact/support_gap.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::Superellipsoid;
using geom_test::PairSet;
using geom_test::Random;

constexpr double kShortest = 2e-5;   ///< the least step of the reference, in units of size over the largest rate
constexpr int kHalvings = 4;         ///< halvings of such a step
constexpr double kGrazing = 1e-2;    ///< normal velocity below this share of the relative one
constexpr double kResolved = 1e-12;  ///< overlaps below this, in units of the size, are rounding
constexpr double kHorizon = 3;

struct MovingPair {
  Superellipsoid shape_a, shape_b;
  RigidMotion a, b;
  bool touching = false;  ///< true if they touch at the start, and part

  double size() const { return shape_a.bounding_radius() + shape_b.bounding_radius(); }
  geom::DistanceResult distance(double t, const Vector3d& start = Vector3d::Zero()) const {
    const geom::Pose X_WA(a.top.at(t).R, a.position_at(t));
    const geom::Pose X_WB(b.top.at(t).R, b.position_at(t));
    return geom::distance(shape_a, X_WA, shape_b, X_WB, {.start = start});
  }
  /// A bound of |dd/dt|.
  double rate() const {
    return (b.velocity - a.velocity).norm() + shape_a.bounding_radius() * a.top.max_omega() +
           shape_b.bounding_radius() * b.top.max_omega();
  }
};

double exponent(Random& random) {
  constexpr std::array kExponents{0.25, 0.3, 0.5, 0.7, 0.9, 1.3, 1.6};
  return kExponents[static_cast<std::size_t>(random.uniform() * kExponents.size())];
}

Superellipsoid random_shape(Random& random) {
  constexpr std::array<std::array<double, 3>, 4> kAxes{{{1, 1, 1}, {1, 1, 2}, {1, 1, 0.5}, {1, 0.8, 0.6}}};
  const auto& a = kAxes[static_cast<std::size_t>(random.uniform() * kAxes.size())];
  const double e1 = exponent(random);
  return Superellipsoid({a[0], a[1], a[2]}, e1, random.coin() ? e1 : exponent(random));
}

Vector3d thermal(Random& random) {
  return random.uniform(0.2, 3) * random.direction();
}

/// A body of a pair: shape and moments of inertia.
struct Kind {
  Superellipsoid shape;
  Vector3d inertia;
};

Kind of_uniform_density(const Superellipsoid& shape) {
  return {shape, shape.inertia(1)};
}

/// A gap to start with: of bodies in touch a rounding error.
double first_gap(Random& random, bool touching, bool grazes, double size) {
  if (touching) return std::floor(random.uniform(-1, 2)) * 1e-15 * size;
  return grazes ? random.log_uniform(1e-9, 1e-2) : random.log_uniform(1e-6, 1);
}

/// A face of B on one of A, parallel to the last bit but one, as in lattices; turned about the normal or not.
geom_test::Orientation parallel_faces(Random& random) {
  geom_test::Orientation o{random.pose(0).rotation(), Matrix3d::Identity(), Vector3d::Zero()};
  const int k = static_cast<int>(3 * random.uniform());
  o.n = o.R_a.col(k);
  const double angle = random.coin() ? 0 : random.uniform(0, 3);
  o.R_b = Eigen::AngleAxisd(angle, o.n).toRotationMatrix() * o.R_a;
  return o;
}

/// Draws bodies near each other. Grazing ones have a normal relative velocity of 1e-6 to 1e-1.
MovingPair random_pair(Random& random, const Kind& A, const Kind& B) {
  const auto set = static_cast<PairSet>(static_cast<int>(5 * random.uniform()));
  const bool parallel = set == PairSet::faces && random.uniform() < 0.3;
  const geom_test::Orientation o = parallel ? parallel_faces(random) : geom_test::choose(set, A.shape, B.shape, random);
  geom::Pose X_WA, X_WB;
  const bool touching = random.uniform() < 0.2;
  const bool grazes = random.uniform() < 0.7;
  const double size = A.shape.bounding_radius() + B.shape.bounding_radius();
  geom_test::place(o, A.shape, B.shape, first_gap(random, touching, grazes, size), X_WA, X_WB);
  MovingPair pair{A.shape, B.shape, {}, {}, touching};
  Vector3d v = thermal(random);
  const double turning = random.coin() ? 1.0 : random.log_uniform(1e-3, 1);
  pair.a.position = X_WA.position();
  pair.b.position = X_WB.position();
  const auto spin = [&](const Matrix3d& R, const Vector3d& inertia) {
    const Vector3d w = thermal(random).cwiseQuotient(inertia.cwiseSqrt());
    return Vector3d(turning * (R * w));
  };
  pair.a.top = FreeTop(A.inertia, X_WA.rotation(), spin(X_WA.rotation(), A.inertia));
  pair.b.top = FreeTop(B.inertia, X_WB.rotation(), spin(X_WB.rotation(), B.inertia));
  if (grazes || touching) {
    // The contact points approach each other slowly, or part.
    const Vector3d p_a = o.R_a * A.shape.support(o.R_a.transpose() * o.n).point;
    const Vector3d p_b = o.R_b * B.shape.support(o.R_b.transpose() * -o.n).point;
    const Vector3d relative = v + pair.b.top.at(0).omega.cross(p_b) - pair.a.top.at(0).omega.cross(p_a);
    const double parting = touching        ? random.log_uniform(1e-5, 1) * relative.norm()
                           : random.coin() ? random.log_uniform(1e-6, 1e-1)
                                           : -random.log_uniform(1e-6, 1e-1);
    v += (parting - relative.dot(o.n)) * o.n;
  }
  pair.b.velocity = v;
  return pair;
}

MovingPair random_pair(Random& random, const Superellipsoid& shape) {
  return random_pair(random, of_uniform_density(shape), of_uniform_density(shape));
}

MovingPair random_equal_pair(Random& random) {
  return random_pair(random, random_shape(random));
}

MovingPair random_pair_apart(Random& random) {
  MovingPair pair = random_equal_pair(random);
  while (pair.touching) pair = random_equal_pair(random);
  return pair;
}

/// An ellipsoid or a superellipsoid of any size, with the moments of some distribution of mass.
Kind random_kind(Random& random, double smallest) {
  const double size = random.log_uniform(smallest, 1);
  const double e1 = random.uniform() < 0.4 ? 1 : exponent(random);
  const double e2 = e1 == 1 || random.coin() ? e1 : exponent(random);
  const Superellipsoid shape(size * Vector3d(1, random.log_uniform(0.25, 1), random.log_uniform(0.25, 4)), e1, e2);
  const Vector3d uniform = shape.inertia(1);
  // Mean squares along the axes; moments of any of these are those of a body.
  Vector3d squares = Vector3d::Constant(0.5 * uniform.sum()) - uniform;
  for (int k = 0; k < 3; ++k) squares[k] *= random.uniform(0.3, 1.5);
  return {shape, Vector3d::Constant(squares.sum()) - squares};
}

/// The least distance near t, by golden sections of [t - h, t + h]; `at` is where.
double least_distance(const MovingPair& pair, double begin, double end, double& at) {
  constexpr double kGolden = 0.61803398874989485;
  double m = end - kGolden * (end - begin);
  double p = begin + kGolden * (end - begin);
  double d_m = pair.distance(m).distance;
  double d_p = pair.distance(p).distance;
  for (int k = 0; k < 40; ++k) {
    if (d_m < d_p) {
      end = p;
      p = m;
      d_p = d_m;
      m = end - kGolden * (end - begin);
      d_m = pair.distance(m).distance;
    } else {
      begin = m;
      m = p;
      d_m = d_p;
      p = begin + kGolden * (end - begin);
      d_p = pair.distance(p).distance;
    }
  }
  at = m;
  return std::min(d_m, d_p);
}

/// The first time in (begin, end) that bisection finds at which the bodies overlap, or infinity: intervals are halved
/// kHalvings times as long as the distances at their ends, which change by no more than `rate`, leave room for it.
double dip(const MovingPair& pair, double rate, double begin, double d_begin, double end, double d_end,
           int halvings = kHalvings) {
  const double overlap = -kResolved * pair.size();
  if (halvings == 0 || 0.5 * (d_begin + d_end - rate * (end - begin)) >= overlap) {
    return std::numeric_limits<double>::infinity();
  }
  const double middle = 0.5 * (begin + end);
  const double d = pair.distance(middle).distance;
  const double before = dip(pair, rate, begin, d_begin, middle, d, halvings - 1);
  if (before < end) return before;
  return d < overlap ? middle : dip(pair, rate, middle, d, end, d_end, halvings - 1);
}

/// A time at which the bodies overlap by more than kResolved, or infinity: the first that steps of the distance over
/// its largest rate find, which are never shorter than kShortest; where one was that long, bisection of it; or a
/// minimum between three of them.
double reference(const MovingPair& pair, double t_end) {
  const double rate = pair.rate();
  const double overlap = -kResolved * pair.size();
  const double shortest = kShortest * pair.size() / rate;
  double t = 0, t1 = 0, t2 = 0, d1 = 0, d2 = 0;
  while (t < t_end) {
    const double d = pair.distance(t).distance;
    if (t > 0) {
      const double between = dip(pair, rate, t1, d1, t, d);
      if (between < t) return between;
    }
    if (d < overlap) return t;
    double at;
    const bool near = d1 < 2 * rate * shortest;
    if (d1 < d2 && d1 <= d && near && least_distance(pair, t2, t, at) < overlap) return at;
    t2 = t1;
    d2 = d1;
    t1 = t;
    d1 = d;
    t += std::max(0.999 * d / rate, shortest);
  }
  return std::numeric_limits<double>::infinity();
}

/// Finding of the search, and its last normal.
struct Found : Finding {
  Vector3d normal;
};

Found find(const SupportGap& gap, FinderCounters& count) {
  Vector3d n = Vector3d::Zero();
  const Finding finding = certified_contact(gap, 0, kHorizon, 100000, n, count);
  return {finding, n};
}

/// A pair gap whose bounds of the curvature are half the right ones.
class HalvedGap : public SupportGap {
 public:
  template <class... Arguments>
  explicit HalvedGap(const Arguments&... arguments) : SupportGap(arguments...) {
    curvature_share_ = 0.5;
  }
};

struct Tally {
  long pairs = 0, contacts = 0, grazing = 0, restarts = 0, missed = 0, late = 0, inexact = 0, wrong = 0, again = 0,
       unanswered = 0, shallow = 0;
};

/// The signed distance is the largest gap along any normal, so that of several answers the largest is right.
double distance_at(const MovingPair& pair, const Found& found) {
  const Vector3d& n = found.normal;
  const Matrix3d R_a = pair.a.top.at(found.time).R;
  const Matrix3d R_b = pair.b.top.at(found.time).R;
  const double gap = n.dot(pair.b.position_at(found.time) - pair.a.position_at(found.time)) -
                     pair.shape_a.support(R_a.transpose() * n).height -
                     pair.shape_b.support(-(R_b.transpose() * n)).height;
  return std::max({gap, pair.distance(found.time).distance, pair.distance(found.time, n).distance});
}

void judge(const MovingPair& pair, const Found& finding, double wanted, Tally& tally) {
  ++tally.pairs;
  if (pair.touching) ++tally.restarts;
  if (finding.outcome == Outcome::contact) {
    ++tally.contacts;
    const double distance = std::abs(distance_at(pair, finding));
    if (!(distance <= 1e-13 * pair.size())) ++tally.inexact;
    if (!(distance <= 1e-12 * pair.size())) ++tally.wrong;
    if (wanted < finding.time - 1e-12) ++tally.late;
    if (!(wanted < kHorizon) && finding.time < 0.9 * kHorizon) ++tally.shallow;
    constexpr double h = 1e-5;
    const double after = pair.distance(finding.time + h).distance;
    const double rate = (after - pair.distance(finding.time - h).distance) / (2 * h);
    const double slow = kGrazing * (pair.b.velocity - pair.a.velocity).norm();
    if (std::abs(rate) < slow) ++tally.grazing;
    // Bodies that go on from a contact overlap. At sharp tips normals differ in g by less than rounding over 1e-3
    // radian, and of those along which they part and approach the search may take the wrong one.
    if (pair.touching && finding.time < 1e-9 && after > slow * h) ++tally.again;
    return;
  }
  // An overlap that is found is a contact that was not.
  if (finding.outcome == Outcome::bound || finding.outcome == Outcome::declined) ++tally.unanswered;
  if (finding.outcome == Outcome::overlapping || (finding.outcome == Outcome::clear && wanted < kHorizon))
    ++tally.missed;
}

const long kContacts = full_form() ? 100000 : 2000;

template <class PairGap, class Draw>
Tally search_pairs(const char* name, const Draw& draw) {
  Random random(1);
  Tally tally;
  FinderCounters count;
  while (tally.contacts < kContacts) {
    const MovingPair pair = draw(random);
    const NormBodyShape a = norm_body(pair.shape_a);
    const NormBodyShape b = norm_body(pair.shape_b);
    const PairGap gap(a, pair.a, b, pair.b, pair.b.position - pair.a.position, 0);
    judge(pair, find(gap, count), reference(pair, kHorizon), tally);
  }
  std::printf(
      "%s: %ld pairs, %ld in touch at first, %ld contacts, %ld grazing: %ld missed, %ld late, %ld unanswered; %ld off "
      "by more than 1e-13 of the size, %ld by more than 1e-12; %ld once more though they part; %ld shallower than the "
      "reference sees; %.2f points in time and %.2f kernel calls a search, %llu rescues\n",
      name, tally.pairs, tally.restarts, tally.contacts, tally.grazing, tally.missed, tally.late, tally.unanswered,
      tally.inexact, tally.wrong, tally.again, tally.shallow,
      static_cast<double>(count.evaluations) / static_cast<double>(count.predictions),
      static_cast<double>(count.kernel_calls) / static_cast<double>(count.predictions),
      static_cast<unsigned long long>(count.rescues));
  return tally;
}

/// Whether some exponents are above 1.
enum class Tips { sharp, round };

void expect_none_missed(const Tally& tally, Tips tips = Tips::sharp) {
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.late, 0);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_LE(tally.inexact, 1);  // 1.6e-13, of 400,000
  EXPECT_LE(tally.again * 1000, tips == Tips::sharp ? tally.contacts : 0);
  EXPECT_EQ(tally.unanswered, 0);
  EXPECT_GE(tally.grazing * 10, tally.contacts);
  EXPECT_GE(tally.restarts * 10, tally.contacts);
  EXPECT_LE(tally.shallow * 100, tally.contacts);
}

TEST(SupportContact, MissesNoContact) {
  expect_none_missed(search_pairs<SupportGap>("superellipsoids", random_equal_pair));
}

TEST(SupportContact, MissesNoneOfBiaxialEllipsoids) {
  expect_none_missed(search_pairs<SupportGap>("biaxial ellipsoids",
                                              [](Random& random) {
                                                return random_pair(random, Superellipsoid({1, 0.8, 0.5}, 1, 1));
                                              }),
                     Tips::round);
}

/// Two equal moments: these turn about their axis and precess.
TEST(SupportContact, MissesNoneOfSymmetricTops) {
  expect_none_missed(search_pairs<SupportGap>("symmetric tops", [](Random& random) {
    const double length = random.coin() ? 0.5 : 2;
    return random_pair(random, Superellipsoid({1, 1, length}, random.coin() ? 1 : exponent(random), 1));
  }));
}

/// Draws bodies of other exponents, proportions, sizes and moments each.
TEST(SupportContact, MissesNoneOfUnlikePairs) {
  expect_none_missed(search_pairs<SupportGap>("unlike pairs", [](Random& random) {
    const Kind a = random_kind(random, 1);
    return random_pair(random, a, random_kind(random, 0.1));
  }));
}

TEST(SupportContact, IsMissedWithHalfTheCurvature) {
  const Tally tally = search_pairs<HalvedGap>("half the curvature", random_equal_pair);
  EXPECT_GT(tally.missed + tally.late, tally.contacts / 100);
}

/// Checks the promise of a single normal: no contact within the step, however good or bad the normal is.
TEST(SupportContact, NoOverlapWithinACertifiedStep) {
  Random random(2);
  const int pairs = full_form() ? 100000 : 2000;
  int long_steps = 0;
  for (int k = 0; k < pairs; ++k) {
    const MovingPair pair = random_pair_apart(random);
    const NormBodyShape a = norm_body(pair.shape_a);
    const NormBodyShape b = norm_body(pair.shape_b);
    const SupportGap gap(a, pair.a, b, pair.b, pair.b.position - pair.a.position, 0);
    const SupportGap::State state = gap.at(0);
    const geom::DistanceResult d = pair.distance(0);
    const double tilt = random.coin() ? 0 : random.log_uniform(1e-9, 1e-1);
    const Vector3d n = (d.normal + tilt * random.direction()).normalized();
    const SupportGap::Evaluation e = gap.evaluate(state, n);
    if (!(e.g > 0)) continue;
    const double step = certified_step(gap, state, e, n, e.g, gap.rate(state, e, n), kHorizon);
    ASSERT_GT(step, 0);
    if (step > 1e-2) ++long_steps;
    for (const double share : {1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0}) {
      ASSERT_GT(pair.distance(share * step).distance, -1e-14 * pair.size()) << "pair " << k << ", step " << step;
    }
  }
  EXPECT_GT(long_steps, pairs / 100);
}

/// Both contact arms of an impulse lead to one point, or to two that are g n apart: else angular momentum is lost. And
/// these are on the surfaces, on flat faces too; vertices (exponents above 1) are the worst.
TEST(SupportContact, PointsAreOnTheSurfacesAndOneGapApart) {
  Random random(3);
  double worst = 0;
  for (int k = 0; k < 2000; ++k) {
    const MovingPair pair = random_pair_apart(random);
    const NormBodyShape a = norm_body(pair.shape_a);
    const NormBodyShape b = norm_body(pair.shape_b);
    Vector3d r = pair.b.position - pair.a.position;
    const geom::DistanceResult apart = pair.distance(0);
    ASSERT_EQ(apart.status, geom::DistanceStatus::separated);
    if (random.coin()) r -= apart.distance * apart.normal;
    const SupportGap gap(a, pair.a, b, pair.b, r, 0);
    const SupportGap::State state = gap.at(0);
    const ContactPoints points = SupportGap::contact_points(state, apart.normal);
    const double g = gap.sample(state, apart.normal).g;
    ASSERT_LE((r + points.b - points.a - g * apart.normal).norm(), 1e-15 * (r.norm() + pair.size())) << "pair " << k;
    const geom::Pose X_WA(pair.a.top.at(0).R, Vector3d(Vector3d::Zero()));
    const geom::Pose X_WB(pair.b.top.at(0).R, r);
    worst = std::max({worst, geom_test::off_surface(pair.shape_a, X_WA, points.a) / pair.size(),
                      geom_test::off_surface(pair.shape_b, X_WB, r + points.b) / pair.size()});
  }
  std::printf("off the surfaces by %.1e of the size at most\n", worst);
  EXPECT_LE(worst, 1e-9);
}

}  // namespace
}  // namespace ed::internal
