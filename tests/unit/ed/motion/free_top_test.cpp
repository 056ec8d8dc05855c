#include <motion/free_top.h>

#include <common/finder/ensemble.h>
#include <common/finder/free_tops.h>
#include <common/finder/top_reference.h>

#include <ed/random.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <ostream>
#include <string>

namespace {

using ed::internal::FreeTop;
using ed::internal::TopState;
using ed::internal::TurnedAngles;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using finder_test::IntegratedTop;
using finder_test::log_uniform;
using free_tops::condition;
using free_tops::difference;
using free_tops::draw_asymmetric;
using free_tops::draw_spherical;
using free_tops::draw_symmetric;
using free_tops::rate_scale;
using free_tops::Start;

using Draw = Start (*)(ed::Random&);

struct Kind {
  std::string name;
  Draw draw;
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

class FreeTops : public testing::TestWithParam<Kind> {
 protected:
  Start draw() { return GetParam().draw(random_); }
  ed::Random random_{71};
};

INSTANTIATE_TEST_SUITE_P(Kinds, FreeTops,
                         testing::Values(Kind{"Spherical", draw_spherical}, Kind{"Symmetric", draw_symmetric},
                                         Kind{"Asymmetric", draw_asymmetric}),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(FreeTops, AreTheIntegratedEquationsOfMotion) {
  for (int k = 0; k < 300; ++k) {
    const Start start = draw();
    const double rate = rate_scale(start);
    const double t = (k % 10 == 0 ? 100 : 5) * random_.normal() / rate;
    IntegratedTop wanted(start.inertia, start.rotation, start.omega);
    wanted.advance(t);
    const FreeTop top = start.top();
    const TopState end = top.at(t);
    const double tolerance = 2e-15 * condition(start) * (1 + rate * std::abs(t));
    EXPECT_LE(difference(end.R, wanted.rotation()), tolerance);
    EXPECT_LE(difference(end.omega, wanted.omega()), tolerance * rate);
    const TurnedAngles turned = top.turned(t);
    EXPECT_LE(difference(turned.world, wanted.turned_world()), tolerance * (1 + rate * std::abs(t)));
    EXPECT_LE(difference(turned.body, wanted.turned_body()), tolerance * (1 + rate * std::abs(t)));
    EXPECT_EQ(top.rotation(t), end.R);
  }
}

TEST_P(FreeTops, StartWhereTheyAreToldTo) {
  for (int k = 0; k < 10'000; ++k) {
    const Start start = draw();
    const TopState now = start.top().at(0);
    EXPECT_LE((now.R - start.rotation).cwiseAbs().maxCoeff(), 2e-15);
    EXPECT_LE((now.omega - start.omega).norm(), 2e-15 * start.omega.norm());
    EXPECT_EQ(start.top().turned(0).world, Vector3d(0, 0, 0));
    EXPECT_EQ(start.top().turned(0).body, Vector3d(0, 0, 0));
  }
}

TEST_P(FreeTops, HaveOrthonormalMatrices) {
  for (int k = 0; k < 10'000; ++k) {
    const Start start = draw();
    const Matrix3d R = start.top().rotation(10 * random_.normal() / rate_scale(start));
    EXPECT_LE((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_GT(R.determinant(), 0.999);
  }
}

TEST_P(FreeTops, KeepAngularMomentumAndEnergy) {
  const auto momentum = [](const Start& s, const Matrix3d& R, const Vector3d& omega) {
    return Vector3d(R * s.inertia.cwiseProduct(R.transpose() * omega));
  };
  for (int k = 0; k < 3000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const Vector3d L = momentum(start, start.rotation, start.omega);
    const double energy = start.omega.dot(L);
    for (const double t : {0.3, 7.0, -50.0}) {
      const TopState now = top.at(t / rate_scale(start));
      const Vector3d L_now = momentum(start, now.R, now.omega);
      // A needle's L is little beside what rounding of its fast spin makes of it.
      EXPECT_LE((L_now - L).norm(), 1e-14 * start.inertia.maxCoeff() * start.omega.norm());
      EXPECT_NEAR(now.omega.dot(L_now), energy, 1e-14 * L.norm() * start.omega.norm());
    }
  }
}

TEST_P(FreeTops, GoOnWhereTheyWereStoppedAndComeBack) {
  for (int k = 0; k < 3000; ++k) {
    const Start start = draw();
    const double rate = rate_scale(start);
    const double t1 = 3 * random_.normal() / rate;
    const double t2 = 3 * random_.normal() / rate;
    const FreeTop top = start.top();
    const TopState half = top.at(t1);
    const TopState end = top.at(t1 + t2);
    const FreeTop rest = Start{start.inertia, half.R, half.omega}.top();
    const FreeTop back = Start{start.inertia, end.R, -end.omega}.top();
    const double tolerance = 3e-15 * condition(start) * (1 + rate * (std::abs(t1) + std::abs(t2)));
    EXPECT_LE((rest.rotation(t2) - end.R).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((rest.at(t2).omega - end.omega).norm(), tolerance * rate);
    EXPECT_LE((back.rotation(t1 + t2) - start.rotation).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((back.at(t1 + t2).omega + start.omega).norm(), tolerance * rate);
    // Integrals add up; the body's axes have not been renamed, the world's have not been turned.
    EXPECT_LE((top.turned(t1).world + rest.turned(t2).world - top.turned(t1 + t2).world).norm(), 5 * tolerance);
    EXPECT_LE((top.turned(t1).body + rest.turned(t2).body - top.turned(t1 + t2).body).norm(), 5 * tolerance);
  }
}

/// Central differences with step h: errors of h^2 (rate^3 or rate^4) / 6, and 1e-16 rate / h of rounding.
TEST_P(FreeTops, HaveTheRatesThatTheyName) {
  for (int k = 0; k < 1000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const double rate = top.max_omega();
    const double t = 5 * random_.normal() / rate;
    const double h = 1e-4 / rate;
    const TopState before = top.at(t - h);
    const TopState now = top.at(t);
    const TopState after = top.at(t + h);
    EXPECT_LE(((after.omega - before.omega) / (2 * h) - now.alpha).norm(), 1e-7 * rate * rate);
    const Matrix3d turning = (after.R - before.R) / (2 * h);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE((turning.col(axis) - now.omega.cross(now.R.col(axis))).norm(), 1e-7 * rate);
    }
  }
}

/// d2 omega / dt2 in the world frame from Euler's equations: R (alpha' + omega x alpha), body frame inside.
Vector3d jerk(const Start& start, const TopState& now) {
  const Vector3d& I = start.inertia;
  const Vector3d w = now.R.transpose() * now.omega;
  const Vector3d a = now.R.transpose() * now.alpha;
  Vector3d rate;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    rate[i] = (I[j] - I[k]) / I[i] * (a[j] * w[k] + w[j] * a[k]);
  }
  return now.R * (rate + w.cross(a));
}

/// Samples all phases of the motion: times from a fraction of a turn to many periods of the slowest top, whose moments
/// agree to 1e-15. No digit is left of the phase then, but omega is one that the top takes.
TEST_P(FreeTops, KeepTheirBoundsAndNearlyReachThem) {
  for (int k = 0; k < 100'000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const double rate = top.max_omega();
    // Every hundredth top is sampled densely.
    const int samples = k % 100 == 0 ? 1000 : 5;
    double omega = 0;
    double alpha = 0;
    double highest_jerk = 0;
    for (int sample = 0; sample < samples; ++sample) {
      const TopState now = top.at(log_uniform(random_, 0.1, 1e18) / rate);
      omega = std::max(omega, now.omega.norm());
      alpha = std::max(alpha, now.alpha.norm());
      highest_jerk = std::max(highest_jerk, jerk(start, now).norm());
    }
    ASSERT_LE(omega, top.max_omega());
    ASSERT_LE(alpha, top.max_alpha());
    // jerk() subtracts rounded numbers.
    const double rounding = 5e-15 * rate * rate * rate;
    ASSERT_LE(highest_jerk, top.max_jerk() + rounding);
    if (samples < 1000) continue;
    EXPECT_GE(omega, 0.99 * top.max_omega());
    EXPECT_GE(alpha, 0.99 * top.max_alpha());
    EXPECT_GE(highest_jerk + rounding, 0.99 * top.max_jerk());
  }
}

TEST_P(FreeTops, StayRightOnVeryLongFlights) {
  // Angles of 1e9 radian keep seven digits; the matrix stays a rotation.
  const Start start = draw();
  const FreeTop top = start.top();
  const double t = 1e9 / rate_scale(start);
  const TopState there = top.at(t);
  EXPECT_LE((there.R.transpose() * there.R - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
  const FreeTop rest = Start{start.inertia, there.R, there.omega}.top();
  EXPECT_LE((rest.rotation(-t) - start.rotation).cwiseAbs().maxCoeff(), 1e-5);
}

/// The states' bits, so that they depend neither on the processor nor on the compiler nor on its options.
TEST_P(FreeTops, HaveTheSameBitsInEveryBuild) {
  const std::map<std::string, std::uint64_t> golden{
      {"Spherical", 0xbb8dd5aa637af2e3}, {"Symmetric", 0xfbeeaecdd039b371}, {"Asymmetric", 0x019533f37f3dcb31}};
  std::uint64_t hash = 14695981039346656037U;
  const auto add = [&](const auto& numbers) {
    for (const double x : numbers.reshaped()) {
      hash ^= std::bit_cast<std::uint64_t>(x + 0.0);  // one zero
      hash *= 1099511628211U;
    }
  };
  for (int k = 0; k < 1000; ++k) {
    // Simple numbers: the functions that draw states use the C library.
    const double shape = GetParam().name == "Spherical" ? 0 : random_.uniform();
    const double other = GetParam().name == "Asymmetric" ? random_.uniform() : shape;
    const FreeTop top(Vector3d(1, 1 + shape, 1 + other), Matrix3d::Identity(),
                      {random_.uniform() - 0.5, random_.uniform() - 0.5, random_.uniform() - 0.5});
    const double t = 200 * (random_.uniform() - 0.5);
    const TopState now = top.at(t);
    add(now.R);
    add(now.omega);
    add(now.alpha);
    add(top.turned(0.1 * t).world);
    add(top.turned(0.1 * t).body);
    add(Vector3d(top.max_omega(), top.max_alpha(), top.max_jerk()));
  }
  EXPECT_EQ(hash, golden.at(GetParam().name)) << std::hex << hash;
}

}  // namespace
