// Dense fluids of hard ellipsoids against tests/reference: short runs, with the error bars that go with them. Each run
// is made once and looked at by several tests.
//
// The reference runs are of the same system (N = 512, the paper's inertia). Their own errors are below 0.1 % for the
// rate and Z, 0.8 % for the diffusion coefficients.

#include <common/ed/measure.h>
#include <common/ed/reference.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <ostream>
#include <string>
#include <utility>

namespace {

using ed_test::Inertia;
using ed_test::Measured;
using ed_test::Protocol;
using ed_test::State;

/// Collision rate: the standard error of these runs is asserted to be below kRateError, so that kRate is at least two
/// of them.
constexpr double kRate = 0.005;
constexpr double kRateError = 0.0025;

constexpr double kZ = 0.01;
constexpr double kZError = 0.004;

/// Diffusion: three standard errors of the short run and this share, in which the mean square displacement's slope may
/// not have settled at the longest lag (about 1 %) and the reference's own error is contained.
constexpr double kDiffusion = 0.03;
constexpr double kDiffusionError = 0.03;

struct Point {
  const char* name;
  State state;
  Protocol protocol;
};

void PrintTo(const Point& point, std::ostream* out) {
  *out << point.name;
}

const Point kRods2{"X0Two", {2, 0.30, 512, Inertia::paper, 71}, {5, 150, 12}};
const Point kRods3{"X0Three", {3, 0.40, 512, Inertia::paper, 72}, {10, 90, 6}};
const Point kDiscsHalf{"X0Half", {0.5, 0.30, 512, Inertia::paper, 73}, {5, 120, 4}};
const Point kDiscsThird{"X0Third", {1.0 / 3, 0.40, 512, Inertia::paper, 74}, {5, 60, 2}};
const Point kSpinningRods{"SpinningX0Three", {3, 0.40, 256, Inertia::uniform, 75}, {5, 100, 4}};
const Point kSpinningDiscs{"SpinningX0Half", {0.5, 0.40, 256, Inertia::uniform, 76}, {5, 100, 4}};

const Measured& run_of(const Point& point) {
  static std::map<std::string, Measured> runs;
  const auto known = runs.find(point.name);
  if (known != runs.end()) return known->second;
  return runs.emplace(point.name, ed_test::measure(point.state, point.protocol)).first->second;
}

double reference(const Point& point, const std::string& column) {
  static const ed_test::ReferenceTable table("dynamics.csv");
  return table.at({{"X0", point.state.aspect_ratio}, {"phi", point.state.packing_fraction}}, column);
}

void print(const Point& point, const char* what, const ed::Estimate& estimate, double wanted) {
  std::printf("%s, phi = %.2f: %s %.5f +- %.5f for %.5f: %+.2f %%, %+.1f standard errors\n", point.name,
              point.state.packing_fraction, what, estimate.value, estimate.error, wanted,
              100 * (estimate.value / wanted - 1), (estimate.value - wanted) / estimate.error);
}

class StatePoint : public testing::TestWithParam<Point> {};

TEST_P(StatePoint, RunIsSound) {
  const Measured& run = run_of(GetParam());
  EXPECT_EQ(run.overlaps, 0U);
  EXPECT_GE(run.audit.minimum_distance, -ed::kAuditOverlap);
  EXPECT_DOUBLE_EQ(run.results.duration, GetParam().protocol.duration);
  EXPECT_GE(run.results.blocks.size(), 10U);
}

/// The total energy is exact, so that both temperatures tell the same; that they are 1 separately is equipartition.
TEST_P(StatePoint, TemperaturesAreEqual) {
  const ed::Results& results = run_of(GetParam()).results;
  print(GetParam(), "translational kT", results.translational_kT, 1);
  print(GetParam(), "rotational kT", results.rotational_kT, 1);
  EXPECT_LE(std::abs(results.translational_kT.value - 1), 3 * results.translational_kT.error);
  EXPECT_LE(std::abs(results.rotational_kT.value - 1), 3 * results.rotational_kT.error);
  EXPECT_LT(results.translational_kT.error, 0.005);
  EXPECT_LT(results.rotational_kT.error, 0.007);
}

std::string name_of_case(const testing::TestParamInfo<Point>& suite) {
  return suite.param.name;
}

INSTANTIATE_TEST_SUITE_P(Fluids, StatePoint,
                         testing::Values(kRods2, kRods3, kDiscsHalf, kDiscsThird, kSpinningRods, kSpinningDiscs),
                         name_of_case);

class ReferencePoint : public testing::TestWithParam<Point> {};

TEST_P(ReferencePoint, CollisionRateAgrees) {
  const ed::Estimate rate = run_of(GetParam()).results.collision_rate;
  const double wanted = reference(GetParam(), "rate");
  print(GetParam(), "rate", rate, wanted);
  EXPECT_LE(std::abs(rate.value / wanted - 1), kRate);
  EXPECT_LT(rate.error, kRateError * wanted);
}

TEST_P(ReferencePoint, CompressibilityFactorAgrees) {
  const ed::Estimate Z = run_of(GetParam()).results.Z;
  const double wanted = reference(GetParam(), "Z");
  print(GetParam(), "Z", Z, wanted);
  EXPECT_LE(std::abs(Z.value / wanted - 1), kZ);
  EXPECT_LT(Z.error, kZError * wanted);
}

INSTANTIATE_TEST_SUITE_P(Fluids, ReferencePoint, testing::Values(kRods2, kRods3, kDiscsHalf, kDiscsThird),
                         name_of_case);

class DiffusionPoint : public testing::TestWithParam<Point> {};

TEST_P(DiffusionPoint, DiffusionCoefficientsAgree) {
  const ed::Results& results = run_of(GetParam()).results;
  for (const auto& [column, estimate] :
       {std::pair{"D_trans", results.D_trans}, {"D_rot", results.D_rot}, {"D_rot_body", results.D_rot_body}}) {
    const double wanted = reference(GetParam(), column);
    print(GetParam(), column, estimate, wanted);
    EXPECT_LE(std::abs(estimate.value - wanted), 3 * estimate.error + kDiffusion * wanted) << column;
    EXPECT_LT(estimate.error, kDiffusionError * wanted) << column;
  }
}

TEST_P(DiffusionPoint, OrientationsDecayAtTheSameTime) {
  const ed::Estimate t = run_of(GetParam()).results.t_C2_1overe;
  const double wanted = reference(GetParam(), "t_C2_1overe");
  print(GetParam(), "t_C2(1/e)", t, wanted);
  EXPECT_LE(std::abs(t.value - wanted), 3 * t.error + 0.02 * wanted);
  EXPECT_LT(t.error, 0.02 * wanted);
}

INSTANTIATE_TEST_SUITE_P(Fluids, DiffusionPoint, testing::Values(kRods2, kRods3), name_of_case);

/// An independent Monte Carlo simulation, which knows no dynamics.
TEST(MonteCarlo, CompressibilityFactorAgrees) {
  const ed_test::ReferenceTable table("simulations.csv");
  for (const Point* point : {&kRods2, &kRods3, &kDiscsHalf}) {
    bool found = false;
    for (std::size_t row = 0; row < table.size(); ++row) {
      if (table.text(row, "system") != "spheroids NVT MC" || table.value(row, "X0") != point->state.aspect_ratio ||
          table.value(row, "phi") != point->state.packing_fraction) {
        continue;
      }
      found = true;
      const double wanted = table.value(row, "Z");
      print(*point, "Z (Monte Carlo)", run_of(*point).results.Z, wanted);
      EXPECT_LE(std::abs(run_of(*point).results.Z.value / wanted - 1), kZ) << point->name;
    }
    EXPECT_TRUE(found) << point->name;
  }
}

}  // namespace
