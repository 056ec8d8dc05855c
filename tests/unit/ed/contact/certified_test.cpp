// The certified search itself: its normals, and its budget.

#include <common/finder/ensemble.h>
#include <common/finder/gap.h>

#include <contact/certified.h>
#include <contact/uniaxial_gap.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace {

using Eigen::Vector3d;

constexpr double kForever = std::numeric_limits<double>::infinity();

/// Passes everything on, and keeps the largest deviation of a normal from unit length.
class WatchedGap : public ed::internal::UniaxialGap<true> {
 public:
  using Base = ed::internal::UniaxialGap<true>;
  WatchedGap(const Base& gap, double& deviation) : Base(gap), deviation_(deviation) {}

  Sample sample(const State& s, const Vector3d& n) const {
    deviation_ = std::max(deviation_, std::abs(n.norm() - 1));
    return Base::sample(s, n);
  }
  Evaluation evaluate(const State& s, const Vector3d& n) const { return complete(s, sample(s, n), n); }

 private:
  double& deviation_;
};

TEST(CertifiedContact, NormalStaysUnitThroughLongSearches) {
  // h and g are computed for unit normals; a normal that is not one by e shifts g by about e times the size, which a
  // refined contact keeps as an overlap. Fast discs take a hundred Newton steps on the way to their contact.
  const std::vector<finder_test::MovingPair> neighbours = finder_test::near_neighbours(0.2, 0.3, 60, 1);
  finder_test::Fluid fluid(0.2, true, neighbours, 2);
  double deviation = 0;
  long longest = 0;
  for (int k = 0; k < 2000; ++k) {
    const finder_test::MovingPair pair = fluid.thermal_pair(20);
    const finder_test::OwnedGap<true> owner(fluid, pair);
    ed::internal::FinderCounters count;
    (void)finder_test::search(WatchedGap(owner.gap(), deviation), 4, count);
    longest = std::max(longest, static_cast<long>(count.evaluations));
  }
  EXPECT_GT(longest, 50) << "the searches were too easy for this test";
  // Of the last step alone (libed/src/contact/rounding.h), and three for the norm taken here.
  EXPECT_LE(deviation, 8 * 0x1p-53);
}

TEST(CertifiedContact, StopsAtItsBudgetWithABoundBelowTheContact) {
  const std::vector<finder_test::MovingPair> neighbours = finder_test::near_neighbours(3, 0.3, 60, 1);
  finder_test::Fluid fluid(3, false, neighbours, 3);
  int bounds = 0;
  for (int k = 0; k < 2000; ++k) {
    const finder_test::MovingPair pair = fluid.thermal_pair();
    const finder_test::OwnedGap<false> owner(fluid, pair);
    ed::internal::FinderCounters count;
    const ed::internal::Finding whole = finder_test::search(owner.gap(), 4, count);
    const double contact = whole.outcome == ed::internal::Outcome::contact ? whole.time : kForever;
    // Going on from the bound with the normal it left leads to the same contact.
    Vector3d n = Vector3d::Zero();
    double t = 0;
    ed::internal::Finding part{};
    do {
      part = ed::internal::certified_contact(owner.gap(), t, 4, 1, n, count);
      if (part.outcome != ed::internal::Outcome::bound) break;
      ++bounds;
      ASSERT_GT(part.time, t);
      ASSERT_LE(part.time, contact * (1 + 1e-13));
      t = part.time;
    } while (true);
    ASSERT_EQ(part.outcome, whole.outcome);
    if (contact < kForever) {
      EXPECT_NEAR(part.time, contact, 1e-10);
    }
  }
  EXPECT_GT(bounds, 1000);
}

}  // namespace
