// Observables of groups of bodies.

#include <common/ed/free_bodies.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace {

using ed_test::free_bodies;
using ed_test::Inertia;
using ed_test::kRounding;
using ed_test::measured;
using ed_test::of_run;
using Eigen::Vector3d;

/// 12 rods of mass 1 and 15 bodies with three different axes of mass 4, whose moments are all equal, so that they turn
/// uniformly; far apart.
ed::System two_species(std::uint64_t seed) {
  ed::System system = ed_test::grid(ed_test::species(3, Inertia::paper), 3, 200);
  ed::Species other = ed::uniform_species(geom::Ellipsoid({0.7, 1, 1.4}), 4);
  other.inertia = Vector3d::Constant(2.5);
  system.species.push_back(other);
  ed::Random random(seed);
  for (int i = 0; i < system.size(); ++i) {
    ed::Body& body = system.bodies[static_cast<std::size_t>(i)];
    body.species = i < 12 ? 0 : 1;
    body.rotation = random.rotation();
    body.velocity = random.normal3();
    Vector3d omega = random.normal3();
    if (body.species == 0) omega.z() = 0;
    body.angular_velocity = body.rotation * omega;
  }
  return system;
}

const std::vector<ed::BodyGroup> kTwoGroups = {{12, 2}, {15, 3}};

/// The mean of f(body) over bodies first .. end - 1.
template <class F>
double mean_over(const ed::System& system, int first, int end, const F& f) {
  double sum = 0;
  for (int i = first; i < end; ++i) sum += f(system.bodies[static_cast<std::size_t>(i)]);
  return sum / (end - first);
}

TEST(ObservablesOfGroups, FreeFlightGivesEachGroupItsDisplacements) {
  const ed::System system = two_species(21);
  const ed::Results results = measured(system, {system.size(), 20, 1, kTwoGroups}, 20);
  ASSERT_EQ(results.groups.size(), 2U);
  const auto v2 = [](const ed::Body& body) { return body.velocity.squaredNorm(); };
  const auto w2 = [](const ed::Body& body) { return body.angular_velocity.squaredNorm(); };
  const double v2_of[] = {mean_over(system, 0, 12, v2), mean_over(system, 12, 27, v2)};
  const double w2_of[] = {mean_over(system, 0, 12, w2), mean_over(system, 12, 27, w2)};
  for (std::size_t k = 0; k < results.lags.size(); ++k) {
    const double t2 = results.lags[k].lag * results.lags[k].lag;
    for (std::size_t g = 0; g < 2; ++g) {
      const ed::LagRow& row = results.groups[g].lags[k];
      EXPECT_EQ(row.lag, results.lags[k].lag);
      EXPECT_NEAR(row.msd.value / t2, v2_of[g], 1e-9 * v2_of[g]) << row.lag;
      EXPECT_NEAR(row.rot_msd.value / t2, w2_of[g], 1e-9 * w2_of[g]) << row.lag;
    }
    const double v2_all = (12 * v2_of[0] + 15 * v2_of[1]) / 27;
    EXPECT_NEAR(results.lags[k].msd.value / t2, v2_all, 1e-9 * v2_all);
  }
}

TEST(ObservablesOfGroups, BodyAxesTurnAsTheyMust) {
  const ed::System system = two_species(22);
  const ed::Results results = measured(system, {system.size(), 20, 1, kTwoGroups}, 20);
  for (const ed::LagRow& row : results.groups[1].lags) {
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const double turned = mean_over(system, 12, 27, [&](const ed::Body& body) {
        return std::pow(body.angular_velocity.dot(body.rotation.col(k)) * row.lag, 2);
      });
      EXPECT_NEAR(row.rot_msd_axis[at].value, turned, kRounding);
      // An axis that makes the angle a with omega: u.u(0) = cos^2 a + sin^2 a cos(w t).
      const double c2 = mean_over(system, 12, 27, [&](const ed::Body& body) {
        const double w = body.angular_velocity.norm();
        const double cosine = body.angular_velocity.dot(body.rotation.col(k)) / w;
        const double x = cosine * cosine + (1 - cosine * cosine) * std::cos(w * row.lag);
        return 1.5 * x * x - 0.5;
      });
      EXPECT_NEAR(row.c2_axis[at].value, c2, kRounding);
    }
    EXPECT_NEAR(row.c2.value, row.c2_axis[2].value, kRounding);
  }
  // Bodies of revolution have one axis, and there is none for all bodies.
  EXPECT_TRUE(std::isnan(results.groups[0].lags.back().c2_axis[0].value));
  EXPECT_TRUE(std::isnan(results.lags.back().rot_msd_axis[0].value));
}

TEST(ObservablesOfGroups, TemperaturesAreThoseOfTheGroup) {
  ed::System system = two_species(23);
  ed::rescale_velocities(system);  // momentum zero, kT = 1 for all together
  const ed::Results results = measured(system, {system.size(), 20, 1, kTwoGroups}, 20);
  const double total_mass = 12 * 1 + 15 * 4;
  const auto v2 = [](const ed::Body& body) { return body.velocity.squaredNorm(); };
  const double freedoms[] = {3 * (12 - 12 / total_mass), 3 * (15 - 60 / total_mass)};
  const double energies[] = {12 * mean_over(system, 0, 12, v2), 15 * 4 * mean_over(system, 12, 27, v2)};
  for (std::size_t g = 0; g < 2; ++g) {
    EXPECT_NEAR(results.groups[g].translational_kT.value, energies[g] / freedoms[g], kRounding);
  }
  EXPECT_NEAR((freedoms[0] * results.groups[0].translational_kT.value +
               freedoms[1] * results.groups[1].translational_kT.value) /
                  (3 * 27 - 3),
              1, kRounding);
  const ed::GroupResults& rods = results.groups[0];
  const ed::GroupResults& others = results.groups[1];
  EXPECT_NEAR((24 * rods.rotational_kT.value + 45 * others.rotational_kT.value) / 69, 1, kRounding);
  // Each axis has as many degrees of freedom as bodies; rods without spin have none about z.
  EXPECT_NEAR((rods.axis_kT[0].value + rods.axis_kT[1].value) / 2, rods.rotational_kT.value, kRounding);
  EXPECT_TRUE(std::isnan(rods.axis_kT[2].value));
  for (int k = 0; k < 3; ++k) {
    const double energy = mean_over(system, 12, 27, [&](const ed::Body& body) {
      return 2.5 * std::pow(body.angular_velocity.dot(body.rotation.col(k)), 2);
    });
    EXPECT_NEAR(others.axis_kT[static_cast<std::size_t>(k)].value, energy, kRounding);
  }
}

TEST(ObservablesOfGroups, CollisionsAreThoseOfTheirBodies) {
  const std::vector<ed::Component> components = {{ed::paper_species(geom::Ellipsoid({1, 1, 1}), 8), 30},
                                                 {ed::paper_species(geom::Ellipsoid({0.5, 0.5, 0.5})), 50}};
  ed::StartOptions start;
  start.packing_fraction = 0.3;
  ed::Simulation simulation(ed::random_start(components, start));
  simulation.record_collisions(100000);
  ed::Observables observables({80, 8, 1, {{30, 2}, {50, 2}}});
  while (observables.next_time() <= 8) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  std::array<double, 2> met{};
  for (const ed::Collision& collision : simulation.collisions()) {
    for (const int body : {collision.i, collision.j}) met[body < 30 ? 0 : 1] += 1;
  }
  EXPECT_EQ(simulation.collisions_of(0, 30), met[0]);
  EXPECT_EQ(simulation.collisions_of(30, 80), met[1]);
  EXPECT_THROW((void)simulation.collisions_of(30, 81), std::invalid_argument);
  const ed::Results results = observables.results(simulation);
  const double time = simulation.time();
  EXPECT_NEAR(results.groups[0].collision_rate.value, met[0] / (30 * time), kRounding * met[0]);
  EXPECT_NEAR(results.groups[1].collision_rate.value, met[1] / (50 * time), kRounding * met[1]);
  EXPECT_GT(std::abs(results.groups[0].collision_rate.value - results.groups[1].collision_rate.value), 1);
  EXPECT_GT(results.groups[0].collision_rate.error, 0);
}

TEST(ObservablesOfGroups, OneGroupIsAllBodies) {
  const ed::System system = ed_test::start({2, 0.45, 40, Inertia::paper, 10});
  ed::Simulation simulation(system);
  ed::Observables observables({system.size(), 32, 2});
  while (observables.next_time() <= 32) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  const ed::Results results = observables.results(simulation);
  ASSERT_EQ(results.groups.size(), 1U);
  ASSERT_GT(results.D_trans.value, 0);
  EXPECT_GT(results.collision_rate.value, 0);
  EXPECT_EQ(results.groups[0].collision_rate.value, results.collision_rate.value);
  EXPECT_EQ(results.groups[0].D_trans.value, results.D_trans.value);
  EXPECT_EQ(results.groups[0].D_rot_body.error, results.D_rot_body.error);
  EXPECT_EQ(results.groups[0].lags.back().c2.value, results.lags.back().c2.value);
  EXPECT_EQ(results.groups[0].S.value, results.S.value);
  // From the state instead of the event loop's own sums.
  EXPECT_NEAR(results.groups[0].translational_kT.value, results.translational_kT.value, kRounding);
  EXPECT_NEAR(results.groups[0].rotational_kT.value, results.rotational_kT.value, kRounding);
}

TEST(ObservablesOfGroups, RotationIsDividedByTheNumberOfItsComponents) {
  // The same bodies, said to rotate about two axes and about three.
  const ed::System system = ed_test::start({2, 0.45, 40, Inertia::paper, 10});
  const auto measure = [&](const std::vector<ed::BodyGroup>& groups) {
    ed::Simulation simulation(system);
    ed::Observables observables({system.size(), 32, 2, groups});
    while (observables.next_time() <= 32) {
      simulation.run_until(observables.next_time());
      observables.measure(simulation);
    }
    return observables.results(simulation);
  };
  const ed::Results two = measure({{40, 2}});
  const ed::Results three = measure({{40, 3}});
  const ed::Results mixed = measure({{10, 2}, {30, 3}});
  ASSERT_GT(two.D_rot.value, 0);
  EXPECT_NEAR(three.D_rot.value, two.D_rot.value * 4 / 6, kRounding);
  EXPECT_NEAR(mixed.D_rot_body.value, two.D_rot_body.value * 4 / 5.5, kRounding);
  EXPECT_NEAR(mixed.D_trans.value, two.D_trans.value, kRounding);
}

TEST(ObservablesOfGroups, HaveToBeGroupsOfTheBodies) {
  using Groups = std::vector<ed::BodyGroup>;
  for (const Groups& groups :
       {Groups{{26, 2}}, Groups{{28, 2}}, Groups{{27, 2}, {1, 2}}, Groups{{27, 1}}, Groups{{0, 2}, {27, 2}},
        Groups{{-1, 2}, {28, 2}}, Groups{{2147483647, 2}, {2147483647, 2}}}) {
    EXPECT_THROW(ed::Observables({27, 20, 1, groups}), std::invalid_argument);
  }
}

TEST(ObservablesOfGroups, OfBodiesWithoutOrientationHaveNoneOfItsNumbers) {
  const ed::System system = free_bodies(1, Inertia::uniform, 6);
  const ed::Results results = measured(system, {system.size(), 20, 1, {{system.size(), 2, false}}}, 20);
  for (const ed::Estimate& e : {results.S, results.D_rot, results.D_rot_body, results.tau_C2, results.t_C2_1overe,
                                results.w2, results.groups[0].S, results.pairs.back().g2, results.lags.back().c2,
                                results.lags.back().rot_msd, results.lags.back().wacf}) {
    EXPECT_TRUE(std::isnan(e.value));
    EXPECT_EQ(e.missing.reason, ed::MissingReason::no_orientation);
  }
  EXPECT_TRUE(std::isnan(results.blocks.back().S));
  // Everything else is as with orientations.
  const ed::Results with = measured(system, {system.size(), 20, 1}, 20);
  EXPECT_EQ(results.lags.back().msd.value, with.lags.back().msd.value);
  EXPECT_EQ(results.lags.back().vacf.value, with.lags.back().vacf.value);
  EXPECT_EQ(results.v2.value, with.v2.value);
  EXPECT_EQ(results.pairs.back().g.value, with.pairs.back().g.value);
}

TEST(ObservablesOfGroups, RotationOfAllIsMeaninglessWhereNothingTurnsSome) {
  // The same bodies, with spheres among them whose free rotation would count as diffusion.
  const std::vector<ed::Component> components = {{ed_test::species(1, Inertia::paper), 4},
                                                 {ed_test::species(2, Inertia::paper), 60}};
  ed::StartOptions start;
  start.packing_fraction = 0.4;
  const ed::Results results = of_run(ed::random_start(components, start), 64, 4, {{4, 2}, {60, 2}});
  EXPECT_EQ(results.groups[0].D_rot.missing.reason, ed::MissingReason::meaningless);
  EXPECT_GT(results.groups[1].D_rot.value, 0);
  EXPECT_TRUE(std::isnan(results.D_rot.value));
  EXPECT_EQ(results.D_rot.missing.reason, ed::MissingReason::meaningless_in_part);
  EXPECT_GT(results.D_trans.value, 0);
  // Blocks share the motion of the spheres, so that their scatter would be too small an error of means over all.
  EXPECT_EQ(results.tau_C2.missing.reason, ed::MissingReason::meaningless_in_part);
  EXPECT_TRUE(std::isnan(results.t_C2_1overe.error));
  EXPECT_TRUE(std::isnan(results.w2.error));
  EXPECT_GT(results.groups[1].t_C2_1overe.error, 0);
  for (const ed::LagRow& row : results.lags) {
    EXPECT_TRUE(std::isnan(row.c2.error) && std::isnan(row.rot_msd.error) && std::isnan(row.wacf.error)) << row.lag;
    EXPECT_TRUE(std::isfinite(row.c2.value)) << row.lag;
  }
}

}  // namespace
