// Sizes: the moments that the header promises, what a seed does, bodies of the same density.

#include <common/ed/states.h>

#include <ed/polydispersity.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace {

using ed::SizeDistribution;

constexpr int kDraws = 200000;
constexpr SizeDistribution kAll[] = {SizeDistribution::uniform, SizeDistribution::gaussian,
                                     SizeDistribution::lognormal};

/// Mean of f over the sizes.
template <class F>
double mean(const std::vector<double>& sizes, const F& f) {
  double sum = 0;
  for (const double size : sizes) sum += f(size);
  return sum / static_cast<double>(sizes.size());
}

TEST(DrawSizes, HaveMeanOneAndTheWidth) {
  for (const SizeDistribution distribution : kAll) {
    for (const double width : {0.01, 0.1, ed::widest(distribution)}) {
      const std::vector<double> sizes = ed::draw_sizes(distribution, width, kDraws, 5);
      const double variance = mean(sizes, [](double s) { return (s - 1) * (s - 1); });
      const double fourth = mean(sizes, [](double s) { return std::pow(s - 1, 4); });
      // Four standard errors of each.
      EXPECT_NEAR(mean(sizes, [](double s) { return s; }), 1, 4 * width / std::sqrt(kDraws)) << to_string(distribution);
      EXPECT_NEAR(variance, width * width, 4 * std::sqrt((fourth - variance * variance) / kDraws))
          << to_string(distribution) << " " << width;
    }
  }
}

TEST(DrawSizes, HaveTheShapeOfTheirDistribution) {
  const auto kurtosis = [](const std::vector<double>& x) {
    const double m = mean(x, [](double s) { return s; });
    const double v = mean(x, [&](double s) { return (s - m) * (s - m); });
    return mean(x, [&](double s) { return std::pow(s - m, 4); }) / (v * v);
  };
  // 9/5 of a uniform one. Of a Gaussian that is cut off at 3, from its fourth moment 3 - (c^3 + 3 c) 2 phi(c) / P and
  // its second 1 - 2 c phi(c) / P: 2.829. Statistical errors of 200,000 draws are below 0.01.
  EXPECT_NEAR(kurtosis(ed::draw_sizes(SizeDistribution::uniform, 0.2, kDraws, 6)), 1.8, 0.02);
  EXPECT_NEAR(kurtosis(ed::draw_sizes(SizeDistribution::gaussian, 0.2, kDraws, 6)), 2.829, 0.04);
  std::vector<double> logarithms = ed::draw_sizes(SizeDistribution::lognormal, 0.2, kDraws, 6);
  for (double& size : logarithms) size = std::log(size);
  EXPECT_NEAR(kurtosis(logarithms), 2.829, 0.04);
}

TEST(DrawSizes, AreCutOff) {
  const auto range = [](SizeDistribution distribution) {
    const std::vector<double> sizes = ed::draw_sizes(distribution, ed::widest(distribution), kDraws, 7);
    return std::pair(*std::min_element(sizes.begin(), sizes.end()), *std::max_element(sizes.begin(), sizes.end()));
  };
  // The limits that the header names, and close to them: 200,000 draws.
  const auto [u0, u1] = range(SizeDistribution::uniform);
  EXPECT_GE(u0, 1 - std::sqrt(0.75));
  EXPECT_LE(u1, 1 + std::sqrt(0.75));
  EXPECT_NEAR(u0, 0.13, 0.01);
  EXPECT_NEAR(range(SizeDistribution::gaussian).first, 0.09, 0.01);
  EXPECT_NEAR(range(SizeDistribution::lognormal).first, 0.21, 0.01);
}

TEST(DrawSizes, FollowTheirSeed) {
  for (const SizeDistribution distribution : kAll) {
    const std::vector<double> sizes = ed::draw_sizes(distribution, 0.1, 100, 8);
    EXPECT_EQ(ed::draw_sizes(distribution, 0.1, 100, 8), sizes);
    EXPECT_NE(ed::draw_sizes(distribution, 0.1, 100, 9), sizes);
    const std::vector<double> more = ed::draw_sizes(distribution, 0.1, 150, 8);
    EXPECT_TRUE(std::equal(sizes.begin(), sizes.end(), more.begin()));
  }
  EXPECT_TRUE(ed::draw_sizes(SizeDistribution::uniform, 0.1, 0, 8).empty());
}

TEST(DrawSizes, RefuseWidthsThatLeaveNoBodies) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const SizeDistribution distribution : kAll) {
    for (const double width : {0.0, -0.1, ed::widest(distribution) * 1.001, 1e300, nan}) {
      EXPECT_THROW((void)ed::draw_sizes(distribution, width, 10, 1), std::invalid_argument) << width;
    }
    EXPECT_THROW((void)ed::draw_sizes(distribution, 0.1, -1, 1), std::invalid_argument);
  }
}

TEST(Scaled, IsTheBodyOfTheSameDensity) {
  const geom::Superellipsoid brick({1, 2, 3}, 0.5, 1.2);
  for (const ed::Species& species : {ed::uniform_species(brick, 2.5), ed::uniform_species(geom::Ellipsoid({1, 2, 3})),
                                     ed::paper_species(ed_test::spheroid(3), 0.7)}) {
    const ed::Species large = ed::scaled(species, 1.7);
    EXPECT_NEAR(large.mass / ed::volume(large.shape), species.mass / ed::volume(species.shape), 1e-14);
    EXPECT_EQ(large.spins, species.spins);
    EXPECT_TRUE(ed::half_extents(large.shape).isApprox(1.7 * ed::half_extents(species.shape), 1e-14));
  }
  const ed::Species large = ed::scaled(ed::uniform_species(brick, 2.5), 1.7);
  EXPECT_TRUE(large.inertia.isApprox(ed::uniform_species(large.shape, large.mass).inertia, 1e-13));
  EXPECT_EQ(std::get<geom::Superellipsoid>(large.shape).e2(), 1.2);
  const ed::Species paper = ed::scaled(ed::paper_species(ed_test::spheroid(3), 0.7), 1.7);
  EXPECT_TRUE(
      paper.inertia.isApprox(ed::paper_species(std::get<geom::Ellipsoid>(paper.shape), paper.mass).inertia, 1e-13));
}

TEST(Scaled, RefusesWhatItCannotScale) {
  const ed::Species ball = ed::uniform_species(ed_test::spheroid(1));
  for (const double factor : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)ed::scaled(ball, factor), std::invalid_argument);
  }
  ed::Species custom = ball;
  custom.shape =
      ed::CustomShape(geom::Ellipsoid({1, 1, 1}), {.name = "ball", .volume = 4.188790204786391, .symmetry_axis = 2});
  EXPECT_THROW((void)ed::scaled(custom, 2), std::invalid_argument);
}

}  // namespace
