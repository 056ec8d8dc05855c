// Pressure and collision rate where theory knows them: hard spheres at any density, spheroids at a low one.

#include <common/ed/measure.h>
#include <common/ed/reference.h>
#include <common/ed/states.h>
#include <common/full_form.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

using ed_test::Inertia;
using ed_test::Measured;
using ed_test::State;

void expect_hard_spheres(double packing_fraction, double duration, std::uint64_t seed) {
  const ed_test::ReferenceTable table("hard_sphere_eos.csv");
  const double Z = table.at({{"phi", packing_fraction}}, "Z_BannermanLueWoodcock2010");
  // In units of the radius; per sphere.
  const double rate = 3 / std::sqrt(std::numbers::pi) * (Z - 1);
  const Measured run =
      ed_test::measure({1, packing_fraction, 512, Inertia::paper, seed}, {10, duration, duration / 20});
  std::printf("spheres, phi = %.2f, %llu collisions: Z %.5f +- %.5f for %.5f, rate %.5f +- %.5f for %.5f (%+.3f %%)\n",
              packing_fraction, static_cast<unsigned long long>(run.collisions), run.results.Z.value,
              run.results.Z.error, Z, run.results.collision_rate.value, run.results.collision_rate.error, rate,
              100 * (run.results.collision_rate.value / rate - 1));
  EXPECT_LE(std::abs(run.results.Z.value / Z - 1), 0.01);
  EXPECT_LE(std::abs(run.results.collision_rate.value / rate - 1), 0.005);
  // The tolerances mean something: the runs are long enough for a third of them.
  EXPECT_LT(run.results.Z.error, 0.003 * Z);
  EXPECT_LT(run.results.collision_rate.error, 0.0017 * rate);
  // Collisions of smooth spheres leave both energies as they are.
  EXPECT_NEAR(run.results.translational_kT.value, 1, 1e-11);
  EXPECT_NEAR(run.results.rotational_kT.value, 1, 1e-11);
}

TEST(HardSpheres, PressureAndCollisionRateAtModerateDensity) {
  expect_hard_spheres(0.30, 300, 81);
}

TEST(HardSpheres, PressureAndCollisionRateAtHighDensity) {
  expect_hard_spheres(0.45, 320, 82);
}

/// Kinetic theory, corrected for density by Enskog's factor with the virial coefficients of Vega (1997): at phi = 0.05
/// right to 0.5 %. The rate of a long run agrees within 1 %; this one is short, and may be off by three standard errors
/// more.
void expect_enskog_rate(double aspect_ratio, std::uint64_t seed) {
  constexpr double kDilute = 0.05;
  constexpr double kTheory = 0.01;
  const ed_test::ReferenceTable table("enskog_spheroids.csv");
  const double wanted = table.at({{"X0", aspect_ratio}, {"phi", kDilute}}, "coll_rate=nu0*chi");
  const double duration = full_form() ? 4000 : 800;
  const Measured run =
      ed_test::measure({aspect_ratio, kDilute, 512, Inertia::paper, seed}, {40, duration, duration / 20});
  const ed::Estimate rate = run.results.collision_rate;
  std::printf("X0 = %.4g, phi = 0.05, %llu collisions: rate %.5f +- %.5f for %.5f (%+.2f %%)\n", aspect_ratio,
              static_cast<unsigned long long>(run.collisions), rate.value, rate.error, wanted,
              100 * (rate.value / wanted - 1));
  EXPECT_LE(std::abs(rate.value - wanted), kTheory * wanted + (full_form() ? 0.0 : 3 * rate.error));
  EXPECT_LT(rate.error, 0.006 * wanted);
}

TEST(DiluteSpheroids, CollisionRateOfFlatDiscs) {
  expect_enskog_rate(1.0 / 3, 83);
}

TEST(DiluteSpheroids, CollisionRateOfDiscs) {
  expect_enskog_rate(0.5, 84);
}

TEST(DiluteSpheroids, CollisionRateOfShortRods) {
  expect_enskog_rate(2, 85);
}

TEST(DiluteSpheroids, CollisionRateOfRods) {
  expect_enskog_rate(3, 86);
}

}  // namespace
