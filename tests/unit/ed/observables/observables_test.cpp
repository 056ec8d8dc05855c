// Observables on motion whose correlations are known exactly: bodies too far apart to meet. And what a run that is too
// short, stopped or very long must give.

#include <common/ed/free_bodies.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed_test::free_bodies;
using ed_test::Inertia;
using ed_test::kRounding;
using ed_test::measured;
using ed_test::of_run;
using Eigen::Vector3d;

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

/// Measures free bodies over a duration; returns the number of frames over the number of lags.
double frames_per_lag(double duration, double longest_lag) {
  const ed::System system = free_bodies(3, Inertia::paper, 9);
  ed::Simulation simulation(system);
  ed::Observables observables({system.size(), duration, longest_lag});
  int frames = 0;
  while (std::isfinite(observables.next_time())) {
    EXPECT_LE(observables.next_time(), duration);
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
    if (++frames > 1000000) break;
  }
  return frames / static_cast<double>(observables.results(simulation).lags.size());
}

TEST(Observables, WantNothingMoreWhenTheDurationIsCovered) {
  // Lags are some at the same times as others, and the last origins have few.
  const double origins = frames_per_lag(3, 3.0 / 16);
  EXPECT_GT(origins, 40);
  EXPECT_LE(origins, 66);
}

TEST(Observables, HaveOriginsATimeUnitApart) {
  // At least 4, at most 16 a longest lag.
  const double unit_apart = frames_per_lag(128, 8);
  EXPECT_GT(unit_apart, 90);
  EXPECT_LE(unit_apart, 130);
  const double most = frames_per_lag(640, 40);
  EXPECT_GT(most, 180);
  EXPECT_LE(most, 258);
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
  // The 15 disjoint stretches are a subset of the 4 x 15 overlapping ones: both estimate the same mean.
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

/// Measures the observables of a run until their planned duration is covered.
void run_to_the_end(ed::Simulation& simulation, ed::Observables& observables) {
  while (std::isfinite(observables.next_time())) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
}

TEST(Observables, ExtendedOnesAreThoseOfTheLongerRun) {
  ed::StartOptions start;
  start.number = 40;
  start.packing_fraction = 0.1;
  const ed::System system = ed::random_start(ed::uniform_species(geom::Ellipsoid({1, 1, 2})), start);
  int undone = 0;
  for (const double duration : {1.6, 3.3, std::nextafter(20 * (0.7 / 4), 0.0), 4.9}) {
    ed::ObservablesOptions options{};
    options.number = system.size();
    options.duration = duration;
    options.longest_lag = 0.7;
    if (duration == 1.6) options.longest_lag = 0;  // its default would follow the duration
    ed::ObservablesOptions longer = options;
    longer.duration = 2.3 * duration;
    if (duration == 1.6) longer.longest_lag = duration / 16;
    ed::Simulation simulation(system, {});
    ed::Observables observables(options);
    run_to_the_end(simulation, observables);
    simulation.run_until(duration);
    // The state at the end of the first run may be saved, and the results asked for.
    (void)observables.results(simulation);
    const std::string end = observables.save();
    ed::Observables restored = ed::Observables::restore(end, options);
    EXPECT_TRUE(restored.save() == end);
    restored.extend(longer.duration);
    // A sample at the end, taken a rounding error early, is undone.
    undone += restored.save().size() < end.size() ? 1 : 0;
    run_to_the_end(simulation, restored);
    ed::Simulation straight(system, {});
    ed::Observables expected(longer);
    run_to_the_end(straight, expected);
    EXPECT_TRUE(restored.save() == expected.save()) << duration;
  }
  EXPECT_GT(undone, 0);
}

TEST(Observables, AreExtendedBeyondWhatWasMeasuredOnly) {
  ed::ObservablesOptions options{};
  options.number = 40;
  options.duration = 2;
  ed::Observables observables(options);
  ed::StartOptions start;
  start.number = options.number;
  start.packing_fraction = 0.1;
  ed::Simulation simulation(ed::random_start(ed::uniform_species(geom::Ellipsoid({1, 1, 2})), start), {});
  run_to_the_end(simulation, observables);
  for (const double duration : {1.9, 1.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(observables.extend(duration), std::invalid_argument) << duration;
  }
  EXPECT_NO_THROW(observables.extend(2.5));
}

}  // namespace
