// Time reversal: negate all velocities and every body goes back where it came from.
//
// The dynamics is chaotic: a rounding error made on the way out is multiplied on the way back by G = exp(lambda T). G
// is measured in each test, by going back again from states in which all bodies are moved and turned by kNudge. The
// return must be as good as an error of kRoundings roundings (of a coordinate, of the order of the box) times G allows;
// the horizon keeps that far below the distance that the bodies have gone, so that a wrong collision cannot hide.

#include <common/ed/families.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace {

using ed_test::Inertia;
using ed_test::State;

constexpr double kNudge = 1e-11;

/// Rounding errors that add up, in units of the roundoff of the largest coordinate: a few for each of the collisions
/// and renewed envelopes of a body. The largest difference of all coordinates has to stay below.
constexpr double kRoundings = 30;
/// Rounding errors where faces meet: a contact point carries some hundred of them there.
constexpr double kRoundingsOfFaces = 300;

/// Largest tolerance of a return, whatever G is: a millionth of a semi-axis.
constexpr double kFarFromWrong = 1e-6;

double periodic_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double box) {
  Eigen::Vector3d d = a - b;
  for (int k = 0; k < 3; ++k) d[k] -= box * std::round(d[k] / box);
  return d.norm();
}

/// The largest difference in position or rotation matrix (the semi-axes are of order 1: lengths, both).
double difference(const ed::System& a, const ed::System& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    worst = std::max(worst, periodic_distance(a.bodies[i].position, b.bodies[i].position, a.box));
    worst = std::max(worst, (a.bodies[i].rotation - b.bodies[i].rotation).norm());
  }
  return worst;
}

ed::System reversed(ed::System system) {
  for (ed::Body& body : system.bodies) {
    body.velocity *= -1;
    body.angular_velocity *= -1;
  }
  return system;
}

ed::System advanced(const ed::System& system, double time, std::uint64_t* collisions = nullptr) {
  ed::Simulation simulation(system);
  simulation.run_until(time);
  if (collisions != nullptr) *collisions = simulation.counters().collisions;
  return simulation.system();
}

/// The largest of kNudges: what one of them does not excite, a nearly grazing contact say, a rounding error may.
double measured_growth(const ed::System& turn, const ed::System& end, double horizon, std::uint64_t seed) {
  constexpr int kNudges = 8;
  ed::Random random(seed);
  double growth = 0;
  for (int k = 0; k < kNudges; ++k) {
    ed::System nudged = turn;
    for (ed::Body& body : nudged.bodies) {
      body.position += kNudge * random.direction();
      body.rotation = Eigen::AngleAxisd(kNudge, random.direction()).toRotationMatrix() * body.rotation;
    }
    growth = std::max(growth, difference(end, advanced(nudged, horizon)) / kNudge);
  }
  return growth;
}

void expect_return(const std::string& what, const ed::System& begin, double horizon, std::uint64_t seed,
                   double roundings = kRoundings) {
  std::uint64_t out = 0;
  std::uint64_t back = 0;
  const ed::System turn = reversed(advanced(begin, horizon, &out));
  const ed::System end = advanced(turn, horizon, &back);
  const double growth = measured_growth(turn, end, horizon, seed);
  const double off = difference(end, begin);
  const double tolerance = roundings * std::numeric_limits<double>::epsilon() * 0.5 * begin.box * growth;
  std::printf("%s: %llu collisions, growth %.1e, off by %.1e, tolerance %.1e, way %.2f\n", what.c_str(),
              static_cast<unsigned long long>(out), growth, off, tolerance, difference(turn, begin));
  EXPECT_EQ(out, back);
  EXPECT_GT(out, 500U);
  // The growth is that of a small difference, not one that has saturated.
  ASSERT_LT(growth * kNudge, 0.1);
  ASSERT_LT(tolerance, kFarFromWrong);
  EXPECT_LE(off, tolerance);
  // Going back undoes something.
  EXPECT_GT(difference(turn, begin), 0.1);
  // Velocities return reversed.
  double velocity_off = 0;
  for (std::size_t i = 0; i < begin.bodies.size(); ++i) {
    velocity_off = std::max(velocity_off, (begin.bodies[i].velocity + end.bodies[i].velocity).norm());
  }
  // What positions differ by goes into velocities at each collision, over a mean free time: the rate, at most 40 here.
  EXPECT_LE(velocity_off, 40 * tolerance);
}

void expect_return(const State& state, double horizon) {
  expect_return(ed_test::describe(state), ed_test::start(state), horizon, state.seed);
}

TEST(TimeReversal, GeneralBodiesReturn) {
  for (const ed_test::Family& family : ed_test::families(216)) {
    SCOPED_TRACE(family.name);
    expect_return(family.name, ed_test::start(family, 0.40), 0.4, 1, kRoundingsOfFaces);
  }
}

TEST(TimeReversal, RodsReturn) {
  expect_return({3, 0.40, 256, Inertia::paper, 31}, 0.4);
}

TEST(TimeReversal, SpinningRodsReturn) {
  expect_return({3, 0.40, 256, Inertia::uniform, 32}, 0.4);
}

TEST(TimeReversal, DiscsReturn) {
  expect_return({0.5, 0.40, 256, Inertia::paper, 33}, 0.4);
}

TEST(TimeReversal, SpinningDiscsReturn) {
  expect_return({0.33, 0.40, 256, Inertia::uniform, 34}, 0.4);
}

TEST(TimeReversal, SpheresReturn) {
  expect_return({1, 0.45, 256, Inertia::paper, 35}, 0.6);
}

}  // namespace
