// Observables on motion whose correlations are known exactly: bodies too far apart to meet. And what a run that is too
// short, stopped or very long must give.

#include <common/ed_states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace {

using ed_test::Inertia;
using Eigen::Vector3d;

/// Sums over some thousand terms of order 1, and positions of order 100 that differ by 1.
constexpr double kRounding = 1e-11;

/// 27 bodies on a grid, with random orientations, velocities and temperatures of exactly 1; 200 apart they do not meet.
ed::System free_bodies(double aspect_ratio, Inertia inertia, std::uint64_t seed, double spacing = 200) {
  ed::System system = ed_test::grid(ed_test::species(aspect_ratio, inertia), 3, spacing);
  ed::Random random(seed);
  for (ed::Body& body : system.bodies) {
    body.rotation = random.rotation();
    body.velocity = random.normal3();
    Vector3d omega = random.normal3();
    if (!system.species[0].spins) omega.z() = 0;
    body.angular_velocity = body.rotation * omega;
  }
  ed::rescale_velocities(system);
  return system;
}

ed::Results measured(const ed::System& system, const ed::ObservablesOptions& options, double until) {
  ed::Simulation simulation(system);
  ed::Observables observables(options);
  double last = -1;
  while (observables.next_time() <= until) {
    EXPECT_GT(observables.next_time(), last);
    last = observables.next_time();
    simulation.run_until(last);
    observables.measure(simulation);
  }
  simulation.run_until(until);
  EXPECT_EQ(simulation.counters().collisions, 0U);
  return observables.results(simulation);
}

TEST(Observables, FreeFlightGivesTheExactDisplacements) {
  const ed::System system = free_bodies(3, Inertia::paper, 1);
  const ed::Results results = measured(system, {system.size(), 20, 1}, 20);
  double v2 = 0;
  double w2 = 0;
  for (const ed::Body& body : system.bodies) {
    v2 += body.velocity.squaredNorm() / system.size();
    w2 += body.angular_velocity.squaredNorm() / system.size();
  }
  ASSERT_EQ(results.lags.size(), 61U);
  EXPECT_DOUBLE_EQ(results.lags.back().lag, 1);
  EXPECT_NEAR(results.lags.front().lag, 1e-3, 1e-15);
  for (const ed::LagRow& row : results.lags) {
    const double t2 = row.lag * row.lag;
    // Displacements of 1e-3 between positions of 300 have 1e-10 of relative rounding error.
    EXPECT_NEAR(row.msd.value / t2, v2, 1e-9 * v2) << row.lag;
    EXPECT_NEAR(row.rot_msd.value / t2, w2, 1e-9 * w2) << row.lag;
    EXPECT_NEAR(row.rot_msd_body.value / t2, w2, 1e-9 * w2) << row.lag;
    double c2 = 0;
    for (const ed::Body& body : system.bodies) {
      const double x = std::cos(body.angular_velocity.norm() * row.lag);
      c2 += (1.5 * x * x - 0.5) / system.size();
    }
    EXPECT_NEAR(row.c2.value, c2, kRounding) << row.lag;
    // All origins are alike.
    EXPECT_NEAR(row.msd.error, 0, 1e-9 * v2 * t2) << row.lag;
  }
}

TEST(Observables, FreeFlightIsNotDiffusion) {
  const ed::System system = free_bodies(3, Inertia::paper, 2);
  const ed::Results results = measured(system, {system.size(), 20, 1}, 20);
  for (const ed::Estimate& D : {results.D_trans, results.D_rot, results.D_rot_body}) {
    EXPECT_TRUE(std::isnan(D.value));
    EXPECT_TRUE(std::isnan(D.error));
  }
  EXPECT_EQ(results.D_trans.missing.reason, ed::MissingReason::ballistic);
  EXPECT_EQ(results.Z.missing.reason, ed::MissingReason::no_collisions);
  EXPECT_EQ(results.D_rot_axis[0].missing.reason, ed::MissingReason::no_such_axis);
  // No collisions: no rate, no pressure from them; rotation is ballistic all the way.
  EXPECT_TRUE(std::isnan(results.collision_rate.value));
  EXPECT_TRUE(std::isnan(results.Z.value));
  EXPECT_TRUE(std::isnan(results.tau_C2.value));
  EXPECT_TRUE(std::isnan(results.beta_C2.value));
}

TEST(Observables, OfBodiesThatNothingTurnsHaveNoRotationalErrors) {
  // Blocks hold the same motion again and again; their scatter of 1e-15 would pass for an error.
  const ed::System system = free_bodies(1, Inertia::uniform, 5);
  const ed::Results results = measured(system, {system.size(), 20, 1}, 20);
  ASSERT_GT(results.lags.size(), 10U);
  for (const ed::LagRow& row : results.lags) {
    for (const ed::Estimate& e : {row.c1, row.c2, row.rot_msd, row.rot_msd_body, row.wacf}) {
      EXPECT_TRUE(std::isfinite(e.value));
      EXPECT_TRUE(std::isnan(e.error)) << e.error;
    }
    EXPECT_TRUE(std::isfinite(row.msd.error));
  }
  EXPECT_TRUE(std::isfinite(results.t_C2_1overe.value));
  EXPECT_TRUE(std::isnan(results.t_C2_1overe.error));
  for (const ed::Estimate& e : {results.D_rot, results.D_rot_body, results.tau_C2, results.beta_C2}) {
    EXPECT_TRUE(std::isnan(e.value));
    EXPECT_EQ(e.missing.reason, ed::MissingReason::meaningless);
  }
}

TEST(Observables, OfSpheresThatMeetHaveNoRotationalErrorsEither) {
  const auto results_of = [](double aspect_ratio) {
    ed::Simulation simulation(free_bodies(aspect_ratio, Inertia::uniform, 6, 4));
    ed::Observables observables({27, 40, 1});
    while (observables.next_time() <= 40) {
      simulation.run_until(observables.next_time());
      observables.measure(simulation);
    }
    simulation.run_until(40);
    EXPECT_GT(simulation.counters().collisions, 20U);
    return observables.results(simulation);
  };
  const ed::Results spheres = results_of(1);
  EXPECT_TRUE(std::isnan(spheres.lags.back().c2.error)) << spheres.lags.back().c2.error;
  EXPECT_GT(spheres.lags.back().msd.error, 1e-6);
  // Bodies that collisions turn, rarely though, have theirs.
  const ed::Results spheroids = results_of(1.2);
  EXPECT_GT(spheroids.lags.back().c2.error, 1e-6);
}

TEST(Observables, SpinIsNoRotationalDisplacement) {
  // The axis of a body that only spins stays; the spin does not count in Delta Phi.
  ed::System system = free_bodies(3, Inertia::uniform, 3);
  for (ed::Body& body : system.bodies) body.angular_velocity = 2.0 * body.rotation.col(2);
  const ed::Results results = measured(system, {system.size(), 4, 1}, 4);
  for (const ed::LagRow& row : results.lags) {
    EXPECT_NEAR(row.rot_msd.value, 0, kRounding);
    EXPECT_NEAR(row.rot_msd_body.value, 0, kRounding);
    EXPECT_NEAR(row.c2.value, 1, kRounding);
  }
  EXPECT_NEAR(results.rotational_kT.value, 0, kRounding);
}

TEST(Observables, SpinIsNoRotationalDisplacementOfOtherShapesEither) {
  // The same ellipsoids as superellipsoids, which another event loop takes: the same displacements.
  ed::System system = free_bodies(3, Inertia::uniform, 3);
  const ed::Results ellipsoids = measured(system, {system.size(), 4, 1}, 4);
  const Vector3d axes = ed::half_extents(system.species[0].shape);
  system.species[0].shape = geom::Superellipsoid(axes, 1, 1);
  const ed::Results others = measured(system, {system.size(), 4, 1}, 4);
  ASSERT_EQ(others.lags.size(), ellipsoids.lags.size());
  for (std::size_t k = 0; k < others.lags.size(); ++k) {
    EXPECT_NEAR(others.lags[k].rot_msd.value, ellipsoids.lags[k].rot_msd.value, kRounding);
    EXPECT_NEAR(others.lags[k].rot_msd_body.value, ellipsoids.lags[k].rot_msd_body.value, kRounding);
    EXPECT_NEAR(others.lags[k].c2.value, ellipsoids.lags[k].c2.value, kRounding);
  }
}

TEST(Observables, BodyComponentsOfTheRotationTurnWithTheBody) {
  // A symmetric top: in the body's frame the angular velocity across the axis turns at (1 - I3 / I) times the spin, so
  // that its integral goes round a circle: |Delta Phi|^2 = (2 w / k)^2 sin^2(k t / 2).
  ed::System system = free_bodies(3, Inertia::uniform, 4);
  const double across = 0.8;
  const double spin = 2.5;
  for (ed::Body& body : system.bodies) body.angular_velocity = body.rotation * Vector3d(across, 0, spin);
  const double k = (1 - system.species[0].inertia.z() / system.species[0].inertia.x()) * spin;
  const ed::Results results = measured(system, {system.size(), 8, 2}, 8);
  for (const ed::LagRow& row : results.lags) {
    EXPECT_NEAR(row.rot_msd_body.value, std::pow(2 * across / k * std::sin(0.5 * k * row.lag), 2), kRounding);
  }
}

TEST(Observables, TemperaturesAndOrderAreThoseOfTheState) {
  ed::System system = free_bodies(3, Inertia::paper, 5);
  for (ed::Body& body : system.bodies) {
    body.angular_velocity.setZero();
    body.rotation.setIdentity();
  }
  const ed::Results results = measured(system, {system.size(), 10, 1}, 10);
  EXPECT_NEAR(results.translational_kT.value, 1, kRounding);
  EXPECT_NEAR(results.translational_kT.error, 0, kRounding);
  EXPECT_NEAR(results.rotational_kT.value, 0, kRounding);
  EXPECT_NEAR(results.S.value, 1, kRounding);
  EXPECT_DOUBLE_EQ(results.duration, 10);
  for (const ed::BlockRow& row : results.blocks) {
    EXPECT_GT(row.end, row.begin);
    EXPECT_NEAR(row.S, 1, kRounding);
    EXPECT_EQ(row.collision_rate, 0);
  }
}

TEST(Observables, MemoryIsBoundedAndNothingIsLostWhenBlocksAreMerged) {
  const ed::System system = free_bodies(3, Inertia::paper, 6);
  double v2 = 0;
  for (const ed::Body& body : system.bodies) v2 += body.velocity.squaredNorm() / system.size();
  for (const double lags : {10, 31, 33, 64, 65, 150}) {
    const double longest = 0.1;
    const ed::Results results = measured(system, {system.size(), lags * longest, longest}, lags * longest);
    EXPECT_LE(results.blocks.size(), 32U) << lags;
    EXPECT_GE(results.blocks.size(), std::min<std::size_t>(static_cast<std::size_t>(lags) - 1, 16U)) << lags;
    EXPECT_NEAR(results.lags.back().msd.value, v2 * longest * longest, 1e-9) << lags;
    // Blocks follow each other without a gap.
    EXPECT_EQ(results.blocks.front().begin, 0);
    for (std::size_t k = 1; k < results.blocks.size(); ++k) {
      EXPECT_EQ(results.blocks[k].begin, results.blocks[k - 1].end) << lags;
    }
  }
}

TEST(Observables, OfARunThatWasStoppedAreThoseSoFar) {
  const ed::System system = free_bodies(3, Inertia::paper, 7);
  const ed::Results results = measured(system, {system.size(), 1000, 10}, 15.3);
  EXPECT_DOUBLE_EQ(results.duration, 15.3);
  // 20 lags a decade from 0.01 on, 10 below down to 0.002.
  ASSERT_EQ(results.lags.size(), 67U);
  EXPECT_NEAR(results.lags.front().lag, 0.01 * std::pow(10, -0.6), 1e-15);
  EXPECT_TRUE(std::isfinite(results.translational_kT.value));
  // A run that has not even seen the longest lag.
  const ed::Results shorter = measured(system, {system.size(), 1000, 10}, 2);
  ASSERT_FALSE(shorter.lags.empty());
  EXPECT_LE(shorter.lags.back().lag, 2 * (1 + 1e-12));
  EXPECT_TRUE(std::isnan(shorter.D_trans.value));
  EXPECT_EQ(shorter.D_trans.missing.reason, ed::MissingReason::lags_too_short);
}

TEST(Observables, OfNoRunAreNull) {
  const ed::System system = free_bodies(3, Inertia::paper, 8);
  const ed::Simulation simulation(system);
  const ed::Observables observables({system.size(), 10});
  EXPECT_EQ(observables.next_time(), 0);
  const ed::Results results = observables.results(simulation);
  EXPECT_EQ(results.duration, 0);
  EXPECT_TRUE(results.lags.empty());
  EXPECT_TRUE(results.blocks.empty());
  for (const ed::Estimate& estimate :
       {results.collision_rate, results.Z, results.translational_kT, results.rotational_kT, results.S, results.D_trans,
        results.D_rot, results.D_rot_body, results.t_C2_1overe, results.tau_C2, results.beta_C2}) {
    EXPECT_TRUE(std::isnan(estimate.value));
    EXPECT_TRUE(std::isnan(estimate.error));
  }
}

TEST(Observables, WantNothingMoreWhenTheDurationIsCovered) {
  const ed::System system = free_bodies(3, Inertia::paper, 9);
  ed::Simulation simulation(system);
  ed::Observables observables({system.size(), 3});
  int samples = 0;
  while (std::isfinite(observables.next_time())) {
    ASSERT_LE(observables.next_time(), 3);
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
    ASSERT_LT(++samples, 1000000);
  }
  // 16 origins a longest lag (a sixteenth of the duration), 61 lags each, some at the same times.
  EXPECT_GT(samples, 1000);
  EXPECT_LE(samples, 257 * 62);
}

// ---- Groups --------------------------------------------------------------------------------------------------------

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

ed::Results of_run(const ed::System& system, double duration, double longest_lag,
                   const std::vector<ed::BodyGroup>& groups = {}) {
  ed::Simulation simulation(system);
  ed::Observables observables({system.size(), duration, longest_lag, groups});
  while (observables.next_time() <= duration) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  return observables.results(simulation);
}

TEST(Observables, OfCagedSpheresHaveNoDiffusionYet) {
  // The MSD of a dense fluid of spheres has the slope 1 where it bends from ballistic motion to the cage, at lags of
  // some tenths: D_trans would be five times what it is.
  const ed::System system = ed_test::start({1, 0.55, 108, Inertia::uniform, 3});
  int straight = 0;
  for (const double longest : {0.4, 0.5}) {
    const ed::Results results = of_run(system, 16 * longest, longest);
    std::vector<double> t, y;
    for (const ed::LagRow& row : results.lags) {
      if (row.lag < 0.4 * longest * (1 - 1e-9)) continue;
      t.push_back(std::log(row.lag));
      y.push_back(std::log(row.msd.value));
    }
    if (std::abs(ed::slope(t, y).value_or(0) - 1) <= 0.2) {
      ++straight;
      EXPECT_EQ(results.D_trans.missing.reason, ed::MissingReason::not_displaced) << longest;
      EXPECT_NEAR(results.D_trans.missing.reached, std::exp(0.5 * y.front()), 1e-12);
      EXPECT_NEAR(results.D_trans.missing.lag, std::exp(t.front()), 1e-12);
    }
    EXPECT_TRUE(std::isnan(results.D_trans.value)) << longest;
  }
  EXPECT_GT(straight, 0);
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
  EXPECT_EQ(results.D_rot.missing.reason, ed::MissingReason::meaningless);
  EXPECT_GT(results.D_trans.value, 0);
}

/// A fluid whose diffusion is certain to have set in, against a direct evaluation of the same run.
TEST(Observables, AgreeWithADirectEvaluation) {
  const ed::System system = ed_test::start({2, 0.45, 40, Inertia::paper, 10});
  ed::Simulation simulation(system);
  ed::Observables observables({system.size(), 32, 2});
  std::vector<ed::Snapshot> origins;  // one longest lag apart
  ed::Snapshot now;
  while (observables.next_time() <= 32) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
    simulation.sample(now);
    if (now.time >= 2.0 * static_cast<double>(origins.size()) * (1 - 1e-12)) origins.push_back(now);
  }
  simulation.run_until(32);
  const ed::Results results = observables.results(simulation);
  const auto collisions = static_cast<double>(simulation.counters().collisions);
  EXPECT_NEAR(results.collision_rate.value, 2 * collisions / (40 * 32), kRounding);
  EXPECT_NEAR(results.Z.value, 1 + simulation.virial() / (3 * 40 * 32 * results.translational_kT.value), kRounding);
  // The 15 disjoint stretches are a subset of the 16 x 15 overlapping ones: both estimate the same mean.
  std::vector<double> msd;
  std::vector<double> c2;
  for (std::size_t k = 1; k < origins.size(); ++k) {
    msd.push_back(ed::msd_between(origins[k - 1], origins[k]));
    c2.push_back(ed::c2_between(origins[k - 1], origins[k]));
  }
  const ed::Estimate direct_msd = ed::mean_of_blocks(msd);
  const ed::Estimate direct_c2 = ed::mean_of_blocks(c2);
  ASSERT_GE(msd.size(), 15U);
  EXPECT_NEAR(results.lags.back().msd.value, direct_msd.value, 3 * direct_msd.error);
  EXPECT_NEAR(results.lags.back().c2.value, direct_c2.value, 3 * direct_c2.error);
  // D is the slope over the last part of the longest lag.
  std::vector<double> t;
  std::vector<double> y;
  for (const ed::LagRow& row : results.lags) {
    if (row.lag < 0.4 * 2 * (1 - 1e-9)) continue;
    t.push_back(row.lag);
    y.push_back(row.msd.value);
  }
  EXPECT_NEAR(results.D_trans.value, ed::slope(t, y).value_or(0) / 6, kRounding);
  EXPECT_GT(results.D_trans.value, 0);
  EXPECT_GT(results.t_C2_1overe.value, 0);
}

}  // namespace
