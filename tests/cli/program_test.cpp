/// The program's parts, as far as test_cli.py cannot reach them: files of failed pairs, configs, formats.

#include "base/suggest.h"
#include "config/config.h"
#include "config/text.h"
#include "io/text_file.h"
#include "run/files/failure_file.h"
#include "run/table.h"

#include <ed/random.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <unistd.h>

namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

/// The pair as written to a file, read, and written again.
hardbody::Failure through_a_file(const hardbody::Failure& failure) {
  const fs::path path = fs::path(testing::TempDir()) / ("hardbody_pair_" + std::to_string(::getpid()) + ".json");
  const std::string text = hardbody::failure_json(failure);
  hardbody::write_file(path, text);
  hardbody::Failure read = hardbody::read_failure(path);
  fs::remove(path);
  EXPECT_EQ(hardbody::failure_json(read), text);
  return read;
}

hardbody::Failure moving_pair(const ed::BodyShape& a, const ed::BodyShape& b) {
  ed::Random random(4);
  hardbody::Failure failure;
  failure.reason = "a \"reason\"";
  ed::FailedPair& pair = failure.pair;
  pair.shape_i = a;
  pair.shape_j = b;
  pair.time = 12.345678901234567;
  pair.i = 3;
  pair.j = 500;
  for (ed::Motion* motion : {&pair.motion_i, &pair.motion_j}) {
    motion->pose = geom::Pose(random.rotation(), random.normal3());
    motion->velocity = random.normal3();
    motion->angular_velocity = random.normal3();
    motion->inertia = {0.3, 0.3, 0.1};
    motion->time = random.uniform();
  }
  return failure;
}

TEST(FailureFile, ReadsBackTheSameBits) {
  const geom::Ellipsoid a({0.7, 0.7, 1.0 / 3});
  const geom::Ellipsoid b({1.1, 1.1, 2.0 / 7});
  ed::Random random(5);
  hardbody::Failure failure = moving_pair(a, b);
  ed::FailedPair& pair = failure.pair;
  pair.finder = ed::Finder::bracketing;
  pair.eps_d = 1.0 / 3e6;
  pair.distance = ed::FailedDistance{ed::DistanceMethod::newton5,
                                     geom::DistanceStatus::singular,
                                     a,
                                     b,
                                     geom::Pose(random.rotation(), random.normal3()),
                                     geom::Pose(random.rotation(), random.normal3()),
                                     {random.normal3(), random.normal3(), geom::SeedStatus::usable}};
  const hardbody::Failure file = through_a_file(failure);
  const ed::FailedPair& read = file.pair;
  EXPECT_EQ(read.motion_j.velocity, pair.motion_j.velocity);
  EXPECT_EQ(read.motion_i.pose.position(), pair.motion_i.pose.position());
  EXPECT_EQ(file.reason, failure.reason);
  ASSERT_TRUE(read.distance.has_value());
  EXPECT_EQ(read.distance->X_WB.rotation(), pair.distance->X_WB.rotation());
  EXPECT_EQ(read.distance->seed.point_a, pair.distance->seed.point_a);
}

TEST(FailureFile, HoldsEveryShape) {
  const geom::Superellipsoid brick({1, 0.7, 1.0 / 3}, 0.3, 1.0 / 3);
  const hardbody::Failure failure = moving_pair(brick, geom::Ellipsoid({1, 2, 3}));
  const hardbody::Failure file = through_a_file(failure);
  const auto& read = std::get<geom::Superellipsoid>(file.pair.shape_i);
  EXPECT_EQ(read.semi_axes(), brick.semi_axes());
  EXPECT_EQ(read.e2(), brick.e2());
  EXPECT_EQ(std::get<geom::Ellipsoid>(file.pair.shape_j).semi_axes(), Vector3d(1, 2, 3));
}

/// Every bit of them.
void expect_same_bodies(const std::vector<ed::Component>& a, const std::vector<ed::Component>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].number, b[k].number);
    EXPECT_EQ(ed::half_extents(a[k].species.shape), ed::half_extents(b[k].species.shape));
    EXPECT_EQ(ed::describe(a[k].species.shape), ed::describe(b[k].species.shape));
    EXPECT_EQ(a[k].species.mass, b[k].species.mass);
    EXPECT_EQ(a[k].species.inertia, b[k].species.inertia);
    EXPECT_EQ(a[k].species.spins, b[k].species.spins);
  }
}

TEST(Config, ResolvedTextReadsBackAsTheSameConfig) {
  const std::string texts[] = {
      "[system]\nnumber = 64\npacking_fraction = 0.02\n[shape]\naspect_ratio = 2\n",
      "seed = 9007199254740993\n[system]\npacking_fraction = 0.1\n[shape]\nsemi_axes = [0.1, 0.7, 0.1]\n"
      "[dynamics]\ninertia = [0.3, 0.1, 0.3]\neps_d = 1e-9\n[equilibration]\ntime = 0.1\n[production]\n"
      "time = 1e6\n[output]\nevents = 3\ncheckpoint_every = \"1.5h\"\n",
      "[system]\npacking_fraction = 0.123456789012345678\n[shape]\naspect_ratio = 0.333333333333333333\n"
      "[dynamics]\ninertia = \"uniform\"\n",
      "[system]\npacking_fraction = 0.1\n[shape]\nsemi_axes = [1, 0.7, 2.1]\n[dynamics]\ninertia = [0.7, 0.8, 0.25]\n",
      "[system]\npacking_fraction = 0.1\n[shape]\nkind = \"superellipsoid\"\nsemi_axes = [1, 1.1, 0.3]\n"
      "exponents = [0.25, 1.6]\n",
      "[system]\npacking_fraction = 0.1\n[shape]\nkind = \"superellipsoid\"\naspect_ratio = 1.7\n"
      "exponents = [0.3333333333333333, 1]\n",
      "[system]\nnumber = 301\npacking_fraction = 0.1\n[[species]]\nsemi_axes = [0.3, 0.3, 0.9]\nfraction = 0.7\n"
      "[[species]]\nkind = \"superellipsoid\"\nexponents = [0.5, 0.5]\nsemi_axes = [0.5, 0.4, 0.45]\n"
      "fraction = 0.3\nmass = 2.5\ninertia = [0.1, 0.11, 0.12]\nsizes = \"lognormal\"\nwidth = 0.123\n",
      "[system]\npacking_fraction = 0.1\n[[species]]\naspect_ratio = 1\nnumber = 100\nsizes = \"uniform\"\n"
      "width = 0.2\nsize_seed = 17\n[[species]]\nsemi_axes = [1, 2, 1]\nnumber = 33\ninertia = \"uniform\"\n",
      "[system]\npacking_fraction = 0.1\nstart = \"fcc\"\n[shape]\naspect_ratio = 2\n",
      "[system]\npacking_fraction = 0.1\nstart = \"cubic\"\nnematic_order = 0.7\n[shape]\naspect_ratio = 2\n"};
  for (const std::string& text : texts) {
    const hardbody::Config config = hardbody::parse_config(text, "memory");
    const std::string resolved = hardbody::resolved_text(config);
    const hardbody::Config again = hardbody::parse_config(resolved, "resolved");
    EXPECT_EQ(hardbody::resolved_text(again), resolved);
    EXPECT_EQ(again.seed, config.seed);
    EXPECT_EQ(again.start, config.start);
    EXPECT_EQ(again.nematic_order, config.nematic_order);
    EXPECT_EQ(again.packing_fraction, config.packing_fraction);
    expect_same_bodies(again.components(), config.components());
    EXPECT_EQ(again.equilibration_time, config.equilibration_time);
    EXPECT_EQ(again.production_time, config.production_time);
  }
}

TEST(Config, PermutesAxesAndMomentsTogether) {
  const hardbody::Config config = hardbody::parse_config(
      "[system]\npacking_fraction = 0.1\n[shape]\nsemi_axes = [4, 2, 2]\n[dynamics]\ninertia = [0.5, 1.5, 1.5]\n",
      "memory");
  const Vector3d axes = std::get<geom::Ellipsoid>(config.species[0].body.shape).semi_axes();
  EXPECT_DOUBLE_EQ(axes.x(), std::cbrt(0.5));
  EXPECT_EQ(axes.x(), axes.y());
  EXPECT_DOUBLE_EQ(axes.z(), 2 * std::cbrt(0.5));
  EXPECT_EQ(config.species[0].body.inertia, Vector3d(1.5, 1.5, 0.5));
  EXPECT_EQ(config.species[0].shape.true_aspect_ratio(), 2);
}

TEST(Suggest, EditDistance) {
  EXPECT_EQ(hardbody::edit_distance("", ""), 0);
  EXPECT_EQ(hardbody::edit_distance("", "abc"), 3);
  EXPECT_EQ(hardbody::edit_distance("number", "nubmer"), 1);
  EXPECT_EQ(hardbody::edit_distance("kitten", "sitting"), 3);
}

TEST(Table, EstimatesShowTwoDigitsOfTheError) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(hardbody::format_estimate({0.28871, 0.00182}), "0.2887 +- 0.0018");
  EXPECT_EQ(hardbody::format_estimate({9.6, 0.0131}), "9.600 +- 0.013");
  EXPECT_EQ(hardbody::format_estimate({9.6, 0.0996}), "9.60 +- 0.10");
  EXPECT_EQ(hardbody::format_estimate({1234.56, 12.3}), "1235 +- 12");
  EXPECT_EQ(hardbody::format_estimate({-1e-3, 2e-4}), "-0.00100 +- 0.00020");
  EXPECT_EQ(hardbody::format_estimate({1, 1e-17}), "1 +- 0");
  EXPECT_EQ(hardbody::format_estimate({0, 0}), "0 +- 0");
  EXPECT_EQ(hardbody::format_estimate({0.5, nan}), "0.5 (no error)");
  EXPECT_EQ(hardbody::format_estimate({nan, nan}), "-");
}

}  // namespace
