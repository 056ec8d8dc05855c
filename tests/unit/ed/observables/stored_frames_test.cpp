// Observables of stored frames where they are known exactly: free flights, walks of independent steps, perfect order.

#include <common/message_of.h>

#include <ed/ed.h>
#include <ed/random.h>
#include <ed/stored_frames.h>

#include <Eigen/Geometry>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace {

using ed::StoredFrame;
using Eigen::Vector3d;

constexpr int kBodies = 60;
constexpr double kBox = 10;
constexpr double kStep = 0.05;
/// Rounding of sums of a thousand terms of order 1, of positions of order 10.
constexpr double kFrameRounding = 1e-11;

ed::StoredFramesOptions options_of(int bodies) {
  ed::StoredFramesOptions options;
  options.box = kBox;
  options.groups = {{bodies, 2}};
  options.axis.assign(static_cast<std::size_t>(bodies), 2);
  return options;
}

/// Each body with a velocity of its own and a turn about an axis across u.
struct Flight {
  explicit Flight(std::size_t frames) {
    ed::Random random(3);
    StoredFrame first;
    std::vector<Vector3d> turn;
    for (int i = 0; i < kBodies; ++i) {
      first.position.push_back(kBox * Vector3d(random.uniform(), random.uniform(), random.uniform()));
      first.rotation.push_back(random.rotation());
      first.velocity.push_back(random.normal3());
      turn.emplace_back(first.rotation.back().col(0));
      rate.push_back(random.uniform());
    }
    for (std::size_t k = 0; k < frames; ++k) {
      StoredFrame frame = first;
      frame.time = 7 + kStep * static_cast<double>(k);
      for (std::size_t i = 0; i < kBodies; ++i) {
        const double t = kStep * static_cast<double>(k);
        frame.position[i] += first.velocity[i] * t;
        frame.rotation[i] = Eigen::AngleAxisd(rate[i] * t, turn[i]) * first.rotation[i];
      }
      stored.push_back(frame);
    }
  }

  /// The mean of f(body).
  template <class F>
  double mean(const F& f) const {
    double sum = 0;
    for (std::size_t i = 0; i < kBodies; ++i) sum += f(i);
    return sum / kBodies;
  }

  double speed(std::size_t i) const { return stored[0].velocity[i].norm(); }

  std::vector<StoredFrame> stored;
  std::vector<double> rate;
};

TEST(StoredFrames, FreeFlightsAreExact) {
  const Flight flight(81);
  ed::StoredFramesOptions options = options_of(kBodies);
  options.wave_numbers = {1.5, 4};
  const ed::StoredResults results = ed::analyze_frames(flight.stored, options);
  EXPECT_EQ(results.frames, 81U);
  EXPECT_EQ(results.wave_numbers, options.wave_numbers);
  ASSERT_GE(results.lags.size(), 10U);
  EXPECT_NEAR(results.lags.back().lag, 20 * kStep, kFrameRounding);  // a quarter of the trajectory
  for (const ed::LagRow& row : results.lags) {
    const double t = row.lag;
    EXPECT_NEAR(row.msd.value, flight.mean([&](auto i) { return std::pow(flight.speed(i) * t, 2); }), kFrameRounding);
    EXPECT_NEAR(row.c1.value, flight.mean([&](auto i) { return std::cos(flight.rate[i] * t); }), kFrameRounding);
    EXPECT_NEAR(row.c2.value,
                flight.mean([&](auto i) { return 1.5 * std::pow(std::cos(flight.rate[i] * t), 2) - 0.5; }),
                kFrameRounding);
    EXPECT_NEAR(row.vacf.value, flight.mean([&](auto i) { return std::pow(flight.speed(i), 2); }), kFrameRounding);
    for (std::size_t k = 0; k < 2; ++k) {
      const double q = options.wave_numbers[k];
      const double wanted = flight.mean([&](auto i) {
        const double x = q * flight.speed(i) * t;
        return std::sin(x) / x;
      });
      EXPECT_NEAR(row.f_self.at(k).value, wanted, kFrameRounding) << "q = " << q << ", t = " << t;
    }
  }
  EXPECT_TRUE(std::isnan(results.D_trans.value)) << "ballistic";
  EXPECT_TRUE(std::isnan(results.Z.value)) << "frames do not tell";
}

TEST(StoredFrames, WithoutVelocitiesTheirCorrelationsHaveNoValue) {
  Flight flight(9);
  for (StoredFrame& frame : flight.stored) frame.velocity.clear();
  const ed::StoredResults results = ed::analyze_frames(flight.stored, options_of(kBodies));
  for (const ed::LagRow& row : results.lags) {
    EXPECT_TRUE(std::isnan(row.vacf.value));
    EXPECT_TRUE(std::isfinite(row.msd.value));
  }
}

TEST(StoredFrames, WithoutRotationsWhatIsMadeOfThemHasNoValue) {
  Flight flight(81);
  const ed::StoredFramesOptions options = options_of(kBodies);
  const ed::StoredResults with = ed::analyze_frames(flight.stored, options);
  for (StoredFrame& frame : flight.stored) frame.rotation.clear();
  const ed::StoredResults without = ed::analyze_frames(flight.stored, options);
  for (const ed::Correlations* of :
       {static_cast<const ed::Correlations*>(&without), static_cast<const ed::Correlations*>(&without.groups[0])}) {
    for (const ed::LagRow& row : of->lags) {
      EXPECT_TRUE(std::isnan(row.c1.value));
      EXPECT_TRUE(std::isnan(row.c2.value));
    }
    for (const ed::PairRow& row : of->pairs) EXPECT_TRUE(std::isnan(row.g2.value));
    EXPECT_TRUE(std::isnan(of->t_C2_1overe.value));
    EXPECT_TRUE(std::isnan(of->tau_C2.value));
  }
  EXPECT_TRUE(std::isnan(without.S.value));
  EXPECT_TRUE(std::isnan(without.director.axis.x()));
  EXPECT_TRUE(std::isnan(without.groups[0].S.value));
  for (const ed::BlockRow& row : without.blocks) EXPECT_TRUE(std::isnan(row.S));
  ASSERT_EQ(without.lags.size(), with.lags.size());
  for (std::size_t k = 0; k < with.lags.size(); ++k) {
    EXPECT_EQ(without.lags[k].msd.value, with.lags[k].msd.value);
    EXPECT_EQ(without.lags[k].vacf.value, with.lags[k].vacf.value);
  }
  ASSERT_EQ(without.pairs.size(), with.pairs.size());
  for (std::size_t k = 0; k < with.pairs.size(); ++k) EXPECT_EQ(without.pairs[k].g.value, with.pairs[k].g.value);
}

TEST(StoredFrames, OnlyFramesThatAreEquallyFarApartAreUsed) {
  Flight flight(12);
  for (std::size_t k = 9; k < 12; ++k) flight.stored[k].time += 0.01;
  EXPECT_EQ(ed::analyze_frames(flight.stored, options_of(kBodies)).frames, 9U);
}

TEST(StoredFrames, CorrelationsAreFromTheLongestEvenStretchAndStructureFromAllFrames) {
  Flight flight(30);
  // 0, 1 | 11, 12, .. 23 | 40, .. 54: two frames, thirteen of one distance, fifteen of half of it.
  for (std::size_t k = 0; k < 30; ++k) {
    const auto n = static_cast<double>(k);
    flight.stored[k].time = k < 2 ? n : k < 15 ? 11 + 2 * n : 40 + n;
  }
  const ed::StoredResults results = ed::analyze_frames(flight.stored, options_of(kBodies));
  EXPECT_EQ(results.first_frame, 15U);
  EXPECT_EQ(results.frames, 15U);
  EXPECT_EQ(results.lags.front().lag, 1);
  const auto speed2 = [&](std::size_t i) { return std::pow(flight.speed(i) * kStep, 2); };
  EXPECT_NEAR(results.lags.front().msd.value, flight.mean(speed2), kFrameRounding);
  // Structure: that of the same frames at even times.
  Flight even(30);
  const ed::StoredResults all = ed::analyze_frames(even.stored, options_of(kBodies));
  ASSERT_EQ(results.pairs.size(), all.pairs.size());
  for (std::size_t k = 0; k < all.pairs.size(); ++k) {
    EXPECT_NEAR(results.pairs[k].g.value, all.pairs[k].g.value, kFrameRounding);
  }
  EXPECT_NEAR(results.S.value, all.S.value, kFrameRounding);
}

TEST(StoredFrames, WrappedPositionsHaveNoDisplacements) {
  const Flight flight(9);
  ed::StoredFramesOptions options = options_of(kBodies);
  options.unwrapped = false;
  const ed::StoredResults results = ed::analyze_frames(flight.stored, options);
  for (const ed::LagRow& row : results.lags) {
    EXPECT_TRUE(std::isnan(row.msd.value));
    EXPECT_TRUE(std::isnan(row.alpha2.value));
    for (const ed::Estimate& f : row.f_self) EXPECT_TRUE(std::isnan(f.value));
    EXPECT_TRUE(std::isfinite(row.c2.value));
    EXPECT_TRUE(std::isfinite(row.vacf.value));
  }
  for (const ed::Estimate* e : {&results.D_trans, &results.t_F_1overe, &results.tau_F}) {
    EXPECT_EQ(e->missing.reason, ed::MissingReason::not_unwrapped);
  }
  EXPECT_EQ(results.D_rot.missing.reason, ed::MissingReason::not_told);
  EXPECT_TRUE(std::isfinite(results.S.value));
}

TEST(StoredFrames, BodiesThatCannotBeFollowedHaveNoCorrelations) {
  const Flight flight(9);
  ed::StoredFramesOptions options = options_of(kBodies);
  options.same_bodies = false;
  const ed::StoredResults results = ed::analyze_frames(flight.stored, options);
  for (const ed::LagRow& row : results.lags) {
    for (const ed::Estimate* e : {&row.msd, &row.alpha2, &row.c1, &row.c2, &row.vacf}) {
      EXPECT_TRUE(std::isnan(e->value));
    }
  }
  for (const ed::Estimate* e : {&results.D_trans, &results.t_F_1overe, &results.t_C2_1overe}) {
    EXPECT_TRUE(std::isnan(e->value));
    EXPECT_EQ(e->missing.reason, ed::MissingReason::not_followed);
  }
  EXPECT_TRUE(std::isfinite(results.S.value));
  EXPECT_FALSE(results.structure.empty());
}

/// Bodies whose steps and turns from frame to frame are independent.
std::vector<StoredFrame> walk(double D_trans, double D_rot, int bodies, int frames, std::uint64_t seed = 8) {
  ed::Random random(seed);
  StoredFrame frame;
  for (int i = 0; i < bodies; ++i) {
    frame.position.push_back(kBox * Vector3d(random.uniform(), random.uniform(), random.uniform()));
    frame.rotation.push_back(random.rotation());
  }
  std::vector<StoredFrame> stored;
  for (int k = 0; k < frames; ++k) {
    frame.time = kStep * k;
    stored.push_back(frame);
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      frame.position[i] += std::sqrt(2 * D_trans * kStep) * random.normal3();
      const Vector3d turn = std::sqrt(2 * D_rot * kStep) * random.normal3();
      frame.rotation[i] = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * frame.rotation[i];
    }
  }
  return stored;
}

/// The mean of P2(u.Ru) over one step R. Of a turn by an angle a about a direction that knows nothing of u it is
/// (1 + 2 cos a + 2 cos 2a) / 5, the character of R over its dimension; a = sigma |x| with three normal numbers x, and
/// the mean of cos(k sigma |x|) is (1 - k^2 sigma^2) exp(-k^2 sigma^2 / 2).
double mean_p2_of_a_step(double D_rot) {
  const double variance = 2 * D_rot * kStep;
  const auto mean_cos = [&](double k) { return (1 - k * k * variance) * std::exp(-0.5 * k * k * variance); };
  return (1 + 2 * mean_cos(1) + 2 * mean_cos(2)) / 5;
}

TEST(StoredFrames, WalksOfIndependentStepsHaveTheirCoefficients) {
  constexpr double kTrans = 0.3;
  constexpr double kRot = 0.4;
  constexpr int kWalkers = 200;
  const std::vector<StoredFrame> stored = walk(kTrans, kRot, kWalkers, 1200);
  ed::StoredFramesOptions options = options_of(kWalkers);
  options.longest_lag = 2.5;
  options.fit_from = 0;
  const ed::StoredResults results = ed::analyze_frames(stored, options);
  EXPECT_EQ(results.frames, stored.size());
  // Four standard errors, which are themselves known to a fifth, and few per cent at most.
  EXPECT_NEAR(results.D_trans.value, kTrans, 4 * results.D_trans.error);
  EXPECT_LT(results.D_trans.error, 0.03 * kTrans);
  const double tau = -kStep / std::log(mean_p2_of_a_step(kRot));
  EXPECT_NEAR(results.tau_C2.value, tau, 4 * results.tau_C2.error);
  EXPECT_LT(results.tau_C2.error, 0.04 * tau);
  EXPECT_NEAR(results.beta_C2.value, 1, 4 * results.beta_C2.error);
  EXPECT_NEAR(results.t_C2_1overe.value, tau, 4 * results.t_C2_1overe.error);

  // Nothing is ballistic: the window that is chosen begins with the first lag.
  options.fit_from.reset();
  const ed::StoredResults chosen = ed::analyze_frames(stored, options);
  EXPECT_EQ(chosen.fit_from, chosen.lags.front().lag);
  EXPECT_EQ(chosen.tau_C2.value, results.tau_C2.value);
  EXPECT_EQ(chosen.tau_C2.error, results.tau_C2.error);
  EXPECT_EQ(chosen.D_rot.missing.reason, ed::MissingReason::not_told);

  options.unwrapped = false;
  const ed::StoredResults wrapped = ed::analyze_frames(stored, options);
  EXPECT_TRUE(std::isnan(wrapped.fit_from));
  EXPECT_TRUE(std::isnan(wrapped.tau_C2.value));
  EXPECT_EQ(wrapped.tau_C2.missing.reason, ed::MissingReason::end_of_ballistic_unknown);
  EXPECT_EQ(wrapped.t_C2_1overe.value, results.t_C2_1overe.value);
}

TEST(StoredFrames, FreeFlightsAreBallisticToTheEnd) {
  const Flight flight(40);
  const ed::StoredResults results = ed::analyze_frames(flight.stored, options_of(kBodies));
  EXPECT_TRUE(std::isnan(results.fit_from));
}

TEST(StoredFrames, FramesAtLogarithmicTimesAreCorrelatedWithTheFirst) {
  Flight flight(13);
  const std::vector<StoredFrame> even = flight.stored;
  const auto at = [&](std::size_t k) { return k == 0 ? 0 : 0.01 * std::pow(1.5, static_cast<double>(k)); };
  for (std::size_t k = 0; k < flight.stored.size(); ++k) {
    flight.stored[k].time = 7 + at(k);
    for (std::size_t i = 0; i < kBodies; ++i) {
      flight.stored[k].position[i] = even[0].position[i] + at(k) * even[0].velocity[i];
    }
  }
  const ed::StoredResults results = ed::analyze_frames(flight.stored, options_of(kBodies));
  EXPECT_TRUE(results.log_times);
  EXPECT_EQ(results.frames, 13U);
  ASSERT_EQ(results.lags.size(), 12U);
  for (std::size_t k = 0; k < 12; ++k) {
    const double lag = at(k + 1);
    EXPECT_NEAR(results.lags[k].lag, lag, kFrameRounding);
    EXPECT_NEAR(results.lags[k].msd.value,
                flight.mean([&](std::size_t i) { return std::pow(flight.speed(i) * lag, 2); }), kFrameRounding);
    EXPECT_TRUE(std::isnan(results.lags[k].msd.error));
  }
  // Intervals that do not only grow, and evenly spaced frames, are none of these.
  flight.stored[12].time = flight.stored[11].time + 0.1;
  EXPECT_FALSE(ed::analyze_frames(flight.stored, options_of(kBodies)).log_times);
  EXPECT_FALSE(ed::analyze_frames(even, options_of(kBodies)).log_times);
}

TEST(StoredFrames, BlocksThatFallShortCountInTheError) {
  // Few bodies, and lags that end where C2 is about 1/e: in some blocks it does not come down to it. Left out, they
  // would make the error too small by half and more.
  constexpr int kWalks = 60;
  int fallen = 0;
  double squares = 0;
  for (int k = 0; k < kWalks; ++k) {
    ed::StoredFramesOptions options = options_of(12);
    options.longest_lag = 0.6;
    const auto results = ed::analyze_frames(walk(0.3, 0.4, 12, 200, 100 + static_cast<std::uint64_t>(k)), options);
    if (!std::isfinite(results.t_C2_1overe.value)) continue;
    EXPECT_GT(results.t_C2_1overe.error, 0);
    const double tau = -kStep / std::log(mean_p2_of_a_step(0.4));
    squares += std::pow((results.t_C2_1overe.value - tau) / results.t_C2_1overe.error, 2);
    ++fallen;
  }
  ASSERT_GT(fallen, kWalks / 2);
  // Errors of a dozen blocks: the mean square is about 1.
  EXPECT_LT(squares / fallen, 2);
}

TEST(StoredFrames, DiffusionAsksForMotionByTheDistanceOfBodies) {
  // 60 bodies in a box of 10: q = 2 pi 0.06^(1/3) = 2.46 where sizes are unknown, 6 / q^2 = 0.99.
  constexpr double kD = 0.3;
  const std::vector<StoredFrame> stored = walk(kD, 0.4, 60, 400);
  ed::StoredFramesOptions options = options_of(60);
  options.length_known = false;
  const auto reason_at = [&](double longest) {
    options.longest_lag = longest;
    const ed::StoredResults results = ed::analyze_frames(stored, options);
    return std::isfinite(results.D_trans.value) ? ed::MissingReason::not_measured : results.D_trans.missing.reason;
  };
  // 0.99 / (6 D) = 0.55: the first lag from 0.4 of the longest on.
  EXPECT_EQ(reason_at(1.15), ed::MissingReason::not_displaced);
  EXPECT_EQ(reason_at(1.6), ed::MissingReason::not_measured);
}

TEST(StoredFrames, PerfectOrderIsFound) {
  StoredFrame frame;
  for (int i = 0; i < 8; ++i) {
    frame.position.emplace_back(i, 0.3 * i, 1);
    frame.rotation.push_back(Eigen::Matrix3d::Identity());
  }
  const ed::StoredResults results = ed::analyze_frames({frame}, options_of(8));
  EXPECT_EQ(results.frames, 1U);
  EXPECT_NEAR(results.S.value, 1, 1e-14);
}

TEST(StoredFrames, BadInputIsRefused) {
  const std::vector<StoredFrame> good = Flight(5).stored;
  const auto message = [](const std::vector<StoredFrame>& frames, const ed::StoredFramesOptions& options) {
    return test_common::message_of([&] { return ed::analyze_frames(frames, options); });
  };
  const auto refused = [&](const ed::StoredFramesOptions& options, const char* why) {
    EXPECT_THAT(message(good, options), testing::StartsWith(why));
  };
  EXPECT_THAT(message({}, options_of(kBodies)), testing::StartsWith("analyze_frames: no frames; accepted: "));
  refused(options_of(kBodies - 1), "analyze_frames: axis; accepted: ");
  ed::StoredFramesOptions options = options_of(kBodies);
  options.box = -1;
  refused(options, "analyze_frames: box; accepted: ");
  options = options_of(kBodies);
  options.length = std::numeric_limits<double>::quiet_NaN();
  refused(options, "analyze_frames: length; accepted: ");
  for (const double lag : {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    options = options_of(kBodies);
    options.fit_from = lag;
    refused(options, "analyze_frames: fit_from; accepted: ");
  }
  options = options_of(kBodies);
  options.wave_numbers.assign(ed::kMostWaveNumbers + 1, 1.0);
  refused(options, "Observables: wave_numbers; accepted: up to 8 ");
  std::vector<StoredFrame> frames = good;
  frames[3].time = frames[2].time;
  EXPECT_THAT(message(frames, options_of(kBodies)),
              testing::StartsWith("analyze_frames: time of frame 3 is 7.1, that of the one before 7.1; accepted: "));
  frames = good;
  frames[4].rotation.pop_back();
  EXPECT_THAT(message(frames, options_of(kBodies)), testing::StartsWith("analyze_frames: frame 4; accepted: "));
}

}  // namespace
