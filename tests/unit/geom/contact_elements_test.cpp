// Contact elements: what they say of the surface, and how a step moves them.

#include "norm/contact_elements.h"
#include "common/geom/random.h"
#include "common/geom/superellipsoid_sets.h"

#include <geom/geom.h>
#include <geom/kernel/norm_bodies.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::any_exponent;
using geom_test::Random;

constexpr LaneBits kNone{0, 0};
constexpr ArcBits kNo{kNone, kNone};
constexpr ArcBits kYes{~kNone, ~kNone};

/// Numbers of one body's lane of one arc that the tests below read.
struct Arc {
  double w0, w1, m0, m1, flat0, flat1;
};

/// The four of both bodies.
std::array<Arc, 4> each(const Arcs& arcs) {
  const auto of = [&arcs](Lanes ArcLanes::*level, int k) {
    return Arc{(arcs.w0.*level)[k], (arcs.w1.*level)[k],    (arcs.m0.*level)[k],
               (arcs.m1.*level)[k], (arcs.flat0.*level)[k], (arcs.flat1.*level)[k]};
  };
  return {of(&ArcLanes::inner, 0), of(&ArcLanes::inner, 1), of(&ArcLanes::outer, 0), of(&ArcLanes::outer, 1)};
}

ArcLanes of_four(const std::array<double, 4>& v) {
  return {Lanes{v[0], v[1]}, Lanes{v[2], v[3]}};
}

/// `arc` is a point of |w|^p = 1 with the gradient there.
void expect_on_curve(const Arc& arc, double e) {
  const double p = 2 / e;
  ASSERT_NEAR(std::pow(arc.w0, p) + std::pow(arc.w1, p), 1, 4e-16 * (1 + p));
  ASSERT_NEAR(arc.m0, std::pow(arc.w0, p - 1), 4e-16 * (1 + p));
  ASSERT_NEAR(arc.m1, std::pow(arc.w1, p - 1), 4e-16 * (1 + p));
  ASSERT_NEAR(arc.w0 * arc.m0 + arc.w1 * arc.m1, 1, 1e-15);
}

TEST(ArcFamily, MakesArcsOfPointsOrOfGradients) {
  Random random(1);
  for (int k = 0; k < 10000; ++k) {
    std::array<double, 4> e, u, v;
    for (std::size_t i = 0; i < 4; ++i) {
      e[i] = i % 2 == 0 ? any_exponent(random) : random.uniform(kMinExponent, kMaxExponent);
      u[i] = random.log_uniform(1e-3, 1e3);
      v[i] = 1;
      if (i % 2 == 1) std::swap(u[i], v[i]);
    }
    const ArcFamily family(of_four(e));
    const std::array<Arc, 4> of_points = each(family.arcs(of_four(u), of_four(v), kYes));
    const std::array<Arc, 4> of_gradients = each(family.arcs(of_four(u), of_four(v), kNo));
    for (std::size_t i = 0; i < 4; ++i) {
      expect_on_curve(of_points[i], e[i]);
      expect_on_curve(of_gradients[i], e[i]);
      const double ratio = u[i] / v[i];
      ASSERT_NEAR(of_points[i].w0 / of_points[i].w1, ratio, 1e-14 * ratio);
      ASSERT_NEAR(of_gradients[i].m0 / of_gradients[i].m1, ratio, 1e-14 * ratio);
      if (of_points[i].w0 > 1e-8) {
        ASSERT_NEAR(of_points[i].flat0 * of_points[i].m0, of_points[i].w0, 1e-13 * of_points[i].w0);
      }
    }
  }
}

/// Arcs end on an axis, where the other component of the point and that of the gradient vanish; their quotient is huge
/// or zero.
TEST(ArcFamily, EndsOnTheAxes) {
  const ArcFamily family(ArcLanes(Lanes{0.5, 1.5}, Lanes{1.5, 0.5}));
  for (const ArcBits of_points : {kNo, kYes}) {
    const std::array<Arc, 4> arcs = each(family.arcs(1, 0, of_points));
    for (const Arc& arc : arcs) {
      EXPECT_EQ(arc.w0, 1);
      EXPECT_EQ(arc.m0, 1);
      EXPECT_LT(arc.w1, 1e-100);
      EXPECT_LT(arc.m1, 1e-100);
      EXPECT_TRUE(std::isfinite(arc.flat1));
    }
    for (const std::size_t steep : {0, 3}) EXPECT_GT(arcs[steep].flat1, 1e15);
    for (const std::size_t pointed : {1, 2}) EXPECT_LT(arcs[pointed].flat1, 1e-15);
  }
}

/// Compares with a ball: for p = 2, and nearly so for p about 2, a face is no flatter, and a vertex as round, also
/// where a component is lost.
TEST(ArcFamily, OfEllipsesIsRoundOnTheAxes) {
  for (const double e : {0.98, 0.999999, 1.0, 1 + 1e-15, 1.000001, 1.001}) {
    const ArcFamily family(e);
    for (const double ratio : {0.0, 1e-40, 1e-30, 1e-21, 1e-19, 1e-5}) {
      for (const ArcBits of_points : {kNo, kYes}) {
        for (const Arc& arc : each(family.arcs(1, ratio, of_points))) {
          EXPECT_NEAR(arc.flat0, 1, 1e-9) << e << ", " << ratio;
          EXPECT_GT(arc.flat1, 0.9) << e << ", " << ratio;
          EXPECT_LT(arc.flat1, 10) << e << ", " << ratio;
          if (e == 1) {
            EXPECT_NEAR(arc.flat1, 1, 1e-13) << ratio;
          }
        }
      }
    }
  }
}

TEST(ArcFamily, ChangesOverWhereItSays) {
  EXPECT_EQ(std::log(ArcFamily::kKnee), ArcFamily::kLogKnee);
}

struct SomePair {
  Superellipsoid a, b;
  Matrix3d R_a, R_b;
  NormBodies bodies;
};

SomePair some_pair(Random& random, double least_e, double most_e) {
  const auto shape = [&] {
    return Superellipsoid({1, random.uniform(0.5, 2), random.uniform(0.5, 2)}, random.uniform(least_e, most_e),
                          random.uniform(least_e, most_e));
  };
  const Superellipsoid a = shape();
  const Superellipsoid b = shape();
  const Matrix3d R_a = random.pose(0).rotation();
  const Matrix3d R_b = random.pose(0).rotation();
  return {a, b, R_a, R_b, NormBodies(NormShape(a), R_a, NormShape(b), R_b)};
}

ContactElements::Element moved(const ContactElements& elements, ContactElements::Element e, const LaneVector& step,
                               const Vector3d& n) {
  elements.move(e, step, n);
  return e;
}

TEST(ContactElements, AreTheSupportPointsWithTheirHessians) {
  Random random(2);
  for (int k = 0; k < 5000; ++k) {
    const SomePair pair = some_pair(random, kMinExponent, kMaxExponent);
    const ContactElements elements(pair.bodies);
    const Vector3d n = random.direction();
    const double least =
        std::min((pair.R_a.transpose() * n).cwiseAbs().minCoeff(), (pair.R_b.transpose() * n).cwiseAbs().minCoeff());
    if (least < 1e-3) continue;  // there Hessians differ by rounding of the powers of that component
    const ContactElements::Element e = elements.at(n);
    const NormBodies::Support s = pair.bodies.support(n);
    ASSERT_LT((e.normal.a() - n).norm(), 2e-15);
    ASSERT_LT((e.normal.b() + n).norm(), 2e-15);
    ASSERT_LT((e.point.a() - s.point.a()).norm(), 1e-14);
    ASSERT_LT((e.point.b() - s.point.b()).norm(), 1e-14);
    const auto hessian = [](const Vector3d& t1, const Vector3d& t2) {
      return Matrix3d(t1 * t1.transpose() + t2 * t2.transpose());
    };
    const Matrix3d H_a = hessian(s.t1.a(), s.t2.a());
    const Matrix3d H_b = hessian(s.t1.b(), s.t2.b());
    ASSERT_LT((hessian(e.t1.a(), e.t2.a()) - H_a).norm(), 1e-12 * H_a.norm());
    ASSERT_LT((hessian(e.t1.b(), e.t2.b()) - H_b).norm(), 1e-12 * H_b.norm());
  }
}

/// x is on the surface with the outward normal n: as the gradient says, or, where that depends on bits of x that it
/// does not have, on vertices and edges, as the support point does.
void expect_on_surface(const Superellipsoid& shape, const Matrix3d& R, const Vector3d& x, const Vector3d& n) {
  const Vector3d body = R.transpose() * x;
  ASSERT_NEAR(shape.value(body), 0, 1e-13);
  const Support support = shape.support(R.transpose() * n);
  ASSERT_NEAR(body.dot(R.transpose() * n), support.height, 4e-15);
  const double off_normal = (R * shape.gradient(body).normalized() - n).norm();
  const double off_point = (support.point - body).norm();
  ASSERT_LT(std::min(off_normal, off_point), 1e-13);
}

/// Moves by a step that does not fit the turn, and across axes: wherever an element goes or begins, it is one of the
/// surface. The length of the normal that it turns towards does not matter.
TEST(ContactElements, StayOnTheSurfaces) {
  Random random(3);
  for (int k = 0; k < 20000; ++k) {
    const SomePair pair = some_pair(random, kMinExponent, kMaxExponent);
    const ContactElements elements(pair.bodies);
    const ContactElements::Element from = elements.at(random.direction());
    const LaneVector step = LaneVector::of(random.log_uniform(1e-9, 1) * random.direction(),
                                           random.log_uniform(1e-9, 1) * random.direction());
    const Vector3d n = (from.normal.a() + random.log_uniform(1e-9, 1) * random.direction()).normalized();
    for (const auto& e : {moved(elements, from, step, n), elements.at_ellipsoids(n)}) {
      expect_on_surface(pair.a, pair.R_a, e.point.a(), e.normal.a());
      expect_on_surface(pair.b, pair.R_b, e.point.b(), e.normal.b());
    }
    // By a power of two, which rounds nothing.
    const ContactElements::Element near = moved(elements, from, step, n);
    const ContactElements::Element far = moved(elements, from, step, std::ldexp(1.0, k % 400 - 200) * n);
    ASSERT_EQ(near.point.a(), far.point.a());
    ASSERT_EQ(near.point.b(), far.point.b());
    ASSERT_EQ(near.normal.a(), far.normal.a());
    ASSERT_EQ(near.normal.b(), far.normal.b());
  }
}

/// Moves by a step and a turn that agree to first order: the new element is off to second order, by whichever variable.
TEST(ContactElements, MoveToFirstOrder) {
  Random random(4);
  int tried = 0;
  for (int k = 0; k < 5000; ++k) {
    const SomePair pair = some_pair(random, 0.3, 1.5);
    const ContactElements elements(pair.bodies);
    const Vector3d n = random.direction();
    const double least =
        std::min((pair.R_a.transpose() * n).cwiseAbs().minCoeff(), (pair.R_b.transpose() * n).cwiseAbs().minCoeff());
    if (least < 0.1) continue;  // the second derivatives' own are large there
    const ContactElements::Element from = elements.at(n);
    const Vector3d turn = n.cross(random.direction());
    const auto off = [&](double angle) {
      const Vector3d delta = angle * turn;
      const LaneVector by_lane = LaneVector::of(delta, -delta);
      const LaneVector step = from.t1.dot(by_lane) * from.t1 + from.t2.dot(by_lane) * from.t2;
      const Vector3d turned = (n + delta).normalized();
      const ContactElements::Element to = moved(elements, from, step, turned);
      const NormBodies::Support s = pair.bodies.support(turned);
      return std::max({(to.normal.a() - turned).norm(), (to.normal.b() + turned).norm(),
                       (to.point.a() - s.point.a()).norm(), (to.point.b() - s.point.b()).norm()});
    };
    ++tried;
    ASSERT_LT(off(1e-5), 0.02 * off(1e-4) + 1e-12) << "the error falls with the square of the step";
  }
  EXPECT_GT(tried, 1000);
}

/// A step across the plane x = 0 of a flat face goes where it leads: the component changes its sign.
TEST(ContactElements, CrossTheAxes) {
  const Superellipsoid box({1, 1, 1}, 0.4, 0.4);
  const Superellipsoid ball({1, 1, 1}, 1, 1);
  const NormBodies bodies(NormShape(box), Matrix3d::Identity(), NormShape(ball), Matrix3d::Identity());
  const ContactElements elements(bodies);
  // The face z = 1 at x = 0.05, y = 0.2: m = w^4.
  const Vector3d n = Vector3d(0.0625e-4, 16e-4, 1).normalized();
  const ContactElements::Element from = elements.at(n);
  ASSERT_NEAR(from.point.a().x(), 0.05, 1e-4);
  const ContactElements::Element to = moved(elements, from, LaneVector::of({-0.08, 0, 0}, Vector3d::Zero()),
                                            Vector3d(-0.0081e-4, 16e-4, 1).normalized());
  // To first order: the tangent of N2 at (0.05, 0.2) changes by 3e-4 over that step, N2 does not.
  EXPECT_NEAR(to.point.a().x(), -0.03, 1e-4);
  EXPECT_NEAR(to.point.a().y(), 0.2, 4e-4);
  EXPECT_LT(to.normal.a().x(), 0);
  expect_on_surface(box, Matrix3d::Identity(), to.point.a(), to.normal.a());
}

/// Crosses the axes of every face, either one and both at once.
TEST(ContactElements, CrossTheAxesOfEveryFace) {
  const Superellipsoid box({1, 1, 1}, 0.4, 0.4);
  const NormBodies bodies(NormShape(box), Matrix3d::Identity(), NormShape(box), Matrix3d::Identity());
  const ContactElements elements(bodies);
  const auto on_face = [](int face, double u, double v) {
    Vector3d x;
    x[face] = 1;
    x[(face + 1) % 3] = u;
    x[(face + 2) % 3] = v;
    return x;
  };
  // p = 5: grad N is along w^4.
  const auto normal_at = [](const Vector3d& x) {
    return Vector3d(x.array().abs().pow(4) * x.array().sign()).normalized();
  };
  struct Crossing {
    double u, v, new_u, new_v;
  };
  for (int face = 0; face < 3; ++face) {
    for (const auto& [u, v, new_u, new_v] :
         {Crossing{0.02, 0.2, -0.01, 0.2}, Crossing{0.2, 0.02, 0.2, -0.01}, Crossing{0.02, 0.03, -0.01, -0.015}}) {
      const Vector3d start = on_face(face, u, v);
      const Vector3d target = on_face(face, new_u, new_v);
      const ContactElements::Element from = elements.at(normal_at(start));
      ASSERT_LT((from.point.a() - start).norm(), 1e-3);
      const Vector3d step = target - start;
      // B's element is that of -n, at -x.
      const ContactElements::Element to = moved(elements, from, LaneVector::of(step, -step), normal_at(target));
      const auto where = [&] { return testing::Message() << "face " << face << ", from " << start.transpose(); };
      EXPECT_LT((to.point.a() - target).norm(), 1e-3) << where();
      EXPECT_LT((to.point.b() + target).norm(), 1e-3) << where();
      expect_on_surface(box, Matrix3d::Identity(), to.point.a(), to.normal.a());
      expect_on_surface(box, Matrix3d::Identity(), to.point.b(), to.normal.b());
    }
  }
}

/// Normals exactly on an axis: the Hessians of ellipsoids are those of the dual method.
TEST(ContactElements, OfEllipsoidsAreRoundAtTheirTips) {
  const Superellipsoid shape({1, 2, 3}, 1, 1);
  const NormBodies bodies(NormShape(shape), Matrix3d::Identity(), NormShape(shape), Matrix3d::Identity());
  for (int k = 0; k < 3; ++k) {
    const Vector3d n = Vector3d::Unit(k);
    const ContactElements::Element e = ContactElements(bodies).at(n);
    const Matrix3d H = e.t1.a() * e.t1.a().transpose() + e.t2.a() * e.t2.a().transpose();
    EXPECT_LT((H - shape.support_hessian(n)).norm(), 1e-14) << k;
  }
}

}  // namespace
}  // namespace geom::kernel
