// Bodies that never meet turn freely: C2(t) of free linear rotors (the paper's inertia: no spin) and of free spherical
// tops, averaged over Maxwellian angular velocities, is known exactly (tests/reference/free_rotor_c2.csv).

#include <common/ed/reference.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using ed_test::Inertia;

/// Bodies along an edge of the grid; 64,000 in all, which gives C2 to 0.002.
constexpr int kAlong = 40;

/// A gas so dilute (packing fraction below 1e-5) that no two bodies meet in the time looked at; velocities and angular
/// velocities are Maxwellian at kT = 1, not rescaled: rescaling fixes the total and would narrow the distribution.
ed::System free_gas(double aspect_ratio, Inertia inertia, std::uint64_t seed) {
  ed::System system = ed_test::grid(ed_test::species(aspect_ratio, inertia), kAlong, 100);
  ed::Random random(seed);
  const Eigen::Vector3d thermal = system.species[0].inertia.cwiseSqrt().cwiseInverse();
  for (ed::Body& body : system.bodies) {
    body.rotation = random.rotation();
    body.velocity = random.normal3();
    Eigen::Vector3d omega = random.normal3().cwiseProduct(thermal);
    if (!system.species[0].spins) omega.z() = 0;
    body.angular_velocity = body.rotation * omega;
  }
  return system;
}

void expect_c2(double aspect_ratio, Inertia inertia, const std::string& column, std::uint64_t seed) {
  const ed_test::ReferenceTable table("free_rotor_c2.csv");
  const ed::System system = free_gas(aspect_ratio, inertia, seed);
  const double unit = std::sqrt(system.species[0].inertia.x());  // of time: sqrt(I / kT)
  ed::Simulation simulation(system);
  ed::Snapshot origin;
  ed::Snapshot now;
  simulation.sample(origin);
  const auto number = static_cast<double>(origin.axis.size());
  double worst = 0;
  for (const double tau : {0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0}) {
    simulation.run_until(tau * unit);
    simulation.sample(now);
    const double c2 = ed::c2_between(origin, now);
    double squares = 0;
    for (std::size_t i = 0; i < origin.axis.size(); ++i) {
      const double x = origin.axis[i].dot(now.axis[i]);
      squares += std::pow(1.5 * x * x - 0.5 - c2, 2);
    }
    const double error = std::sqrt(squares / (number * (number - 1)));
    const double exact = table.at({{"tau=t*sqrt(kT/I)", tau}}, column);
    worst = std::max(worst, std::abs(c2 - exact) / error);
    EXPECT_LE(std::abs(c2 - exact), 3 * error) << "tau " << tau << ": " << c2 << " for " << exact << " +- " << error;
    EXPECT_LT(error, 0.0025);
  }
  EXPECT_EQ(simulation.counters().collisions, 0U);
  std::printf("X0 = %.3g, %s inertia: %s within %.2f standard errors\n", aspect_ratio, ed_test::name_of(inertia),
              column.c_str(), worst);
}

TEST(FreeRotor, RodsFollowTheLinearRotor) {
  expect_c2(3, Inertia::paper, "C2_linear_rotor", 61);
}

TEST(FreeRotor, DiscsFollowTheLinearRotor) {
  expect_c2(0.5, Inertia::paper, "C2_linear_rotor", 62);
}

TEST(FreeRotor, SpinningSpheresFollowTheSphericalTop) {
  expect_c2(1, Inertia::uniform, "C2_spherical_top", 63);
}

}  // namespace
