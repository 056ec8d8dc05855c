/// Rows of pooled replicas, costs and bundles of runs.

#include "sweep/replicas.h"
#include "config/config.h"
#include "io/toml_document.h"
#include "report/sweep.h"
#include "sweep/table.h"
#include "sweep/tasks/bundles.h"
#include "sweep/tasks/cost.h"
#include "sweep/tasks/cost_model.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace {

using hardbody::PointRecord;
using hardbody::PointStatus;
using hardbody::PooledPoint;
using hardbody::PrintedEstimate;
using testing::ElementsAre;
using testing::HasSubstr;

/// Replicas that are done, with these values of Z.
std::vector<PointRecord> replicas_of(const std::vector<double>& values, double error = 0.1) {
  std::vector<PointRecord> list;
  for (const double value : values) {
    PointRecord record;
    record.replica = static_cast<int>(list.size());
    record.directory = hardbody::replica_directory("a=1", record.replica);
    record.status = PointStatus::done;
    record.results.emplace();
    record.results->production_time = "10";
    record.results->wall_seconds = "1";
    record.results->observables = {{"Z", fmt::format("{}", value), fmt::format("{}", error)}};
    list.push_back(record);
  }
  return list;
}

TEST(PooledPoints, DirectoriesAreNamed) {
  EXPECT_EQ(hardbody::replica_directory("a=1", 0), "a=1");
  EXPECT_EQ(hardbody::replica_directory("a=1", 2), "a=1_replica=2");
  EXPECT_EQ(hardbody::replica_directory("", 0), "replica=0");
}

TEST(PooledPoints, ValueIsMissingIfOneReplicaHasNone) {
  std::vector<PointRecord> runs = replicas_of({1, 2, 3});
  for (PointRecord& run : runs) run.results->observables.push_back({"D", "0.5", "0.01"});
  runs[1].results->observables.back() = {"D", "", "", "bodies have not moved"};
  const PooledPoint point = hardbody::pooled_point(runs);
  ASSERT_EQ(point.record.results->observables.size(), 2u);
  EXPECT_EQ(point.record.results->observables[0].value, "2");
  EXPECT_EQ(point.record.results->observables[1].value, "");
  EXPECT_EQ(point.record.results->observables[1].missing, "1 of 3 replicas: bodies have not moved");
  EXPECT_EQ(point.agreement.size(), 1u);
  EXPECT_EQ(point.record.results->wall_seconds, "3");
}

TEST(PooledPoints, DirectorsAreNotPooled) {
  std::vector<PointRecord> runs = replicas_of({1, 2});
  for (PointRecord& run : runs) run.results->observables.push_back({"director_x", "0.5", "0.01", "", true});
  EXPECT_EQ(hardbody::pooled_point(runs).record.results->observables[1].value, "");
}

TEST(PooledPoints, DecaysAtOtherWaveNumbersAreNotPooled) {
  std::vector<PointRecord> runs = replicas_of({1, 2});
  for (PointRecord& run : runs) run.results->observables.push_back({"t_F_1overe", "0.5", "0.01"});
  EXPECT_EQ(hardbody::pooled_point(runs).record.results->observables[1].value, "0.5");
  runs[1].results->wave_number = "2.9";
  const PooledPoint point = hardbody::pooled_point(runs);
  EXPECT_EQ(point.record.results->observables[1].value, "");
  EXPECT_THAT(point.record.results->observables[1].missing, HasSubstr("production.wave_numbers sets them"));
  EXPECT_EQ(point.record.results->observables[0].value, "1.5");
}

TEST(PooledPoints, StatusIsThatOfTheWorst) {
  std::vector<PointRecord> runs = replicas_of({1, 2, 3});
  EXPECT_EQ(hardbody::pooled_point(runs).record.status, PointStatus::done);
  runs[2].status = PointStatus::running;
  PooledPoint point = hardbody::pooled_point(runs);
  EXPECT_EQ(point.record.status, PointStatus::running);
  EXPECT_EQ(point.number, 2u);
  runs[1].status = PointStatus::failed;
  runs[1].message = "jammed";
  point = hardbody::pooled_point(runs);
  EXPECT_EQ(point.record.status, PointStatus::failed);
  EXPECT_EQ(point.record.message, "replica 1: jammed");
}

TEST(PooledPoints, TheSameRunTwiceIsRefused) {
  const PooledPoint point = hardbody::pooled_point(replicas_of({1, 2, 1}));
  EXPECT_EQ(point.record.status, PointStatus::failed);
  EXPECT_THAT(point.record.message, HasSubstr("replicas 0 and 2 are the same run"));
}

TEST(PooledPoints, SeedsOfAReportFollowTheSameRule) {
  hardbody::SweepPointReport first;
  first.status = "done";
  first.values = {{2, 0.25}};
  hardbody::SweepPointReport second = first;
  second.values = {{4, 0.25}};
  EXPECT_EQ(hardbody::pooled_over({&first, &second}, 0).value, 3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  second.values = {{nan, nan, "no diffusion yet"}};
  const hardbody::Measured missing = hardbody::pooled_over({&first, &second}, 0);
  EXPECT_TRUE(std::isnan(missing.value));
  EXPECT_EQ(missing.missing, "no diffusion yet");
  second.status = "pending";
  EXPECT_EQ(hardbody::pooled_over({&first, &second}, 0).value, 2);
}

TEST(PooledPoints, OutlierIsNamedByItsReplica) {
  std::vector<PointRecord> runs = replicas_of({1, 1.05, 0.98, 3, 1.01});
  const PooledPoint point = hardbody::pooled_point(runs);
  EXPECT_THAT(point.record.note, HasSubstr("Z: replica 3 is "));
  EXPECT_THAT(hardbody::agreement_csv({point}), HasSubstr(",3,17.8\n"));
  // With one still to come the number is that of the replica, not of the row.
  runs[0].status = PointStatus::running;
  EXPECT_THAT(hardbody::pooled_point(runs).record.note, HasSubstr("Z: replica 3 is "));
}

/// Points along a key whose cost grows by a factor of ten.
std::vector<PointRecord> points_along(const std::vector<double>& values, std::size_t done) {
  std::vector<PointRecord> list;
  for (const double x : values) {
    PointRecord record;
    hardbody::Value value;
    value.kind = hardbody::Value::Kind::real;
    value.real = x;
    record.point.name = record.directory = fmt::format("x={}", x);
    record.point.settings = {{"x", "", value, value}};
    record.cost = hardbody::Cost{5, 500};
    if (list.size() < done) {
      record.status = PointStatus::done;
      record.results.emplace();
      record.results->wall_seconds = fmt::format("{}", 10 * std::pow(10, x));
      record.results->peak_memory_bytes = "1000";
    }
    list.push_back(record);
  }
  return list;
}

TEST(TaskCosts, AreBetweenThoseOfTheNeighbours) {
  const std::vector<PointRecord> points = points_along({0, 0.4, 0.8, 1, 0.6, 0.2}, 4);
  const hardbody::Costs costs(points);
  const std::optional<hardbody::Cost> cost = costs.of(4);
  ASSERT_TRUE(cost);
  EXPECT_GT(cost->seconds, 10 * std::pow(10, 0.4));
  EXPECT_LT(cost->seconds, 10 * std::pow(10, 0.8));
  EXPECT_EQ(cost->memory, 1000);
  EXPECT_GT(costs.error(), 1);
  EXPECT_LT(costs.error(), 3);
}

TEST(TaskCosts, AreThoseOfConfigsWhereNothingIsDone) {
  std::vector<PointRecord> points = points_along({0, 1}, 0);
  const hardbody::Costs costs(points);
  ASSERT_TRUE(costs.of(0));
  EXPECT_EQ(costs.of(0)->seconds, 5);
  EXPECT_EQ(costs.error(), hardbody::kCostModelFactor);
  points[1].cost.reset();  // an invalid config
  EXPECT_FALSE(costs.of(1));
}

/// Expected seconds of 512 bodies with a shape, at a packing fraction.
double expected_seconds(const std::string& shape, double phi, const std::string& more = "") {
  const std::string text =
      fmt::format("[system]\nnumber = 512\npacking_fraction = {}\n[shape]\n{}\n{}", phi, shape, more);
  return hardbody::cost_by_config(hardbody::read_config(hardbody::read_toml(text, "config", {}))).seconds;
}

TEST(TaskCosts, FollowRelaxationAndShape) {
  const std::string precise = "[production]\ntarget_error = 0.03\n";
  const std::string rods = "kind = \"ellipsoid\"\naspect_ratio = 3.2",
                    spheres = "kind = \"ellipsoid\"\naspect_ratio = 1";
  const std::string nearly = "kind = \"ellipsoid\"\naspect_ratio = 1.1", cubes = "kind = \"box\"\nedges = [1, 1, 1]";
  const std::string fixed = "[equilibration]\ntime = 8\n[production]\ntime = 100\n";
  // Seconds that such runs took on a Xeon, each alone.
  EXPECT_NEAR(std::log(expected_seconds(rods, 0.49, precise) / 112), 0, std::log(1.3));
  EXPECT_NEAR(std::log(expected_seconds("kind = \"ellipsoid\"\naspect_ratio = 2.2", 0.3, precise) / 7.6), 0,
              std::log(1.3));
  EXPECT_NEAR(std::log(expected_seconds("kind = \"ellipsoid\"\naspect_ratio = 0.2", 0.3, precise) / 48.5), 0,
              std::log(1.5));
  EXPECT_NEAR(std::log(expected_seconds(spheres, 0.275, precise) / 2.35), 0, std::log(1.3));
  // Rotations of what is nearly a sphere relax slowly, and the more so in a gas; the equilibration says how long a run
  // is.
  EXPECT_GT(expected_seconds(nearly, 0.15) / expected_seconds(nearly, 0.15, fixed), 10);
  EXPECT_LT(expected_seconds(rods, 0.15) / expected_seconds(rods, 0.15, fixed), 4);
  EXPECT_GT(expected_seconds(cubes, 0.4, fixed) / expected_seconds(spheres, 0.4, fixed), 10);
  // A coefficient twice as precise needs four times the production, after the same start.
  const std::string finer = "[production]\ntarget_error = 0.015\n";
  const double longer = expected_seconds(rods, 0.3, finer) / expected_seconds(rods, 0.3, precise);
  EXPECT_GT(longer, 2.5);
  EXPECT_LT(longer, 4);
}

TEST(TaskBundles, AreAsLongAsWished) {
  std::vector<PointRecord> points = points_along({0, 0.1, 0.2, 0.3, 0.4}, 1);
  const hardbody::Cost ten{10, 100};
  const std::vector<std::optional<hardbody::Cost>> costs = {ten, ten, ten, ten, std::nullopt};
  std::vector<hardbody::Bundle> bundles = hardbody::bundles_of(points, costs, 25);
  ASSERT_EQ(bundles.size(), 3u);
  EXPECT_THAT(bundles[0].runs, ElementsAre(1, 2));
  EXPECT_EQ(bundles[0].seconds, 20);
  EXPECT_THAT(bundles[1].runs, ElementsAre(3));
  EXPECT_THAT(bundles[2].runs, ElementsAre(4));
  EXPECT_FALSE(bundles[2].seconds);
  // A chain against the order of the records, its first run done: 0 <- 4 <- 2, and 1, 3 by themselves.
  points[4].starts_from = 0;
  points[2].starts_from = 4;
  bundles = hardbody::bundles_of(points, costs, 25);
  ASSERT_EQ(bundles.size(), 3u);
  EXPECT_THAT(bundles[0].runs, ElementsAre(1, 3));
  EXPECT_THAT(bundles[1].runs, ElementsAre(4));
  EXPECT_FALSE(bundles[1].after);
  EXPECT_THAT(bundles[2].runs, ElementsAre(2));
  EXPECT_EQ(bundles[2].after, bundles[1].id);
}

TEST(TaskBundles, AreAtLeastAsManyAsJobs) {
  std::vector<PointRecord> points = points_along({0, 0.1, 0.2, 0.3, 0.4, 0.5}, 1);
  const auto cost = [](double seconds) { return std::optional(hardbody::Cost{seconds, 100}); };
  const std::vector<std::optional<hardbody::Cost>> costs = {cost(9), cost(2), cost(7), cost(4), cost(3), cost(5)};
  // 21 seconds for 3 jobs: 7, 5 + 2, 4 + 3.
  std::vector<hardbody::Bundle> bundles = hardbody::bundles_of(points, costs, 600, 3);
  ASSERT_EQ(bundles.size(), 3u);
  EXPECT_THAT(bundles[0].runs, ElementsAre(2));
  EXPECT_THAT(bundles[1].runs, ElementsAre(1, 5));
  EXPECT_THAT(bundles[2].runs, ElementsAre(3, 4));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(bundles[k].id, static_cast<int>(k) + 1);
    EXPECT_EQ(bundles[k].seconds, 7);
    EXPECT_EQ(bundles[k].memory, 100);
  }
  // More jobs than runs: one run each. Longer sweeps: no longer than wished, as for any number of jobs.
  EXPECT_EQ(hardbody::bundles_of(points, costs, 600, 64).size(), 5u);
  bundles = hardbody::bundles_of(points, costs, 6, 2);
  std::size_t runs = 0;
  for (const hardbody::Bundle& bundle : bundles) {
    runs += bundle.runs.size();
    EXPECT_TRUE(*bundle.seconds <= 6 || bundle.runs.size() == 1);
  }
  EXPECT_EQ(runs, 5u);
}

TEST(TaskBundles, OfChainsStayInOrderForAnyNumberOfJobs) {
  std::vector<PointRecord> points = points_along({0, 0.1, 0.2, 0.3, 0.4, 0.5}, 0);
  const std::vector<std::optional<hardbody::Cost>> costs(6, hardbody::Cost{10, 100});
  points[1].starts_from = 0;
  points[2].starts_from = 1;
  points[4].starts_from = 3;
  const std::vector<hardbody::Bundle> bundles = hardbody::bundles_of(points, costs, 600, 8);
  ASSERT_EQ(bundles.size(), 3u);
  EXPECT_THAT(bundles[0].runs, ElementsAre(5));
  EXPECT_THAT(bundles[1].runs, ElementsAre(0, 1, 2));
  EXPECT_THAT(bundles[2].runs, ElementsAre(3, 4));
}

}  // namespace
