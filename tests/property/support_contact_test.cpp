// Contact times of superellipsoids against a search that shares nothing with the finder but the distance and the free
// motion: conservative advancement, whose steps are the distance over a bound of its rate. Pairs of five kinds of
// orientation (faces, edges and vertices included), of which many graze, and one in five starts as a collision leaves
// it: in touch, parting. HARDBODY_FULL=1: 100,000 contacts.

#include "property/support_reference.h"

#include "common/full_form.h"
#include "common/geom/random.h"
#include "common/geom/superellipsoid_sets.h"

#include <contact/body_shapes.h>
#include <contact/certified.h>
#include <contact/support_gap.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ed::internal {
namespace {

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
    const NormBodyShape a = norm_body(pair.shape_a).value();
    const NormBodyShape b = norm_body(pair.shape_b).value();
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
    const NormBodyShape a = norm_body(pair.shape_a).value();
    const NormBodyShape b = norm_body(pair.shape_b).value();
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
    const NormBodyShape a = norm_body(pair.shape_a).value();
    const NormBodyShape b = norm_body(pair.shape_b).value();
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
