// Where slopes and decays of a time correlation are numbers, and the reason where they are none: on curves that are
// known.

#include "observables/curves.h"

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>

namespace {

using ed::MissingReason;
using ed::internal::Curve;
using ed::internal::Reach;

/// 20 lags a decade up to `longest`, three decades.
Curve curve_of(double longest, const std::function<double(double)>& f) {
  Curve curve;
  for (int k = 0; k <= 60; ++k) {
    curve.t.push_back(longest * std::pow(10.0, (k - 60) / 20.0));
    curve.y.push_back(f(curve.t.back()));
  }
  return curve;
}

/// Ballistic, then caged: the slope is 1 where (t / crossover)^2 = 1.
double caged(double t) {
  constexpr double kPlateau = 0.2;
  constexpr double kCrossover = 0.26;
  const double x = t / kCrossover;
  return kPlateau * x * x / (1 + x * x);
}

/// Requirements in a dense fluid of spheres: q = 3.5 / l.
const Reach kFluid = ed::internal::reach_of_translation(3.5, 0);

MissingReason reason_of(const std::optional<ed::Missing>& missing) {
  return missing ? missing->reason : MissingReason::not_measured;
}

TEST(Diffusion, IsNotWhatPassesSlopeOneOnItsWayToACage) {
  const Curve curve = curve_of(0.42, caged);
  // The slope alone would take it.
  EXPECT_FALSE(ed::internal::why_not_diffusive(curve, Reach{}));
  const auto missing = ed::internal::why_not_diffusive(curve, kFluid);
  ASSERT_EQ(reason_of(missing), MissingReason::not_displaced);
  // It says what is asked for: the displacement at the first lag of the fit, 7 of 20 of a decade before the longest.
  const double first = 0.42 * std::pow(10.0, -7 / 20.0);
  EXPECT_DOUBLE_EQ(missing->lag, first);
  EXPECT_DOUBLE_EQ(missing->reached, std::sqrt(caged(first)));
  EXPECT_EQ(ed::describe(*missing), "bodies have moved 0.26 l by lag 0.19, where the fit begins: no diffusion yet");
  EXPECT_EQ(ed::describe(*missing, ""), "bodies have moved 0.26 by lag 0.19, where the fit begins: no diffusion yet");
}

/// Free motion that is forgotten after a time of 1, and diffusion.
double brownian(double t) {
  return t - 1 + std::exp(-t);
}

TEST(Ballistic, EndsHalfwayToDiffusion) {
  // The power of time from t to the first lag at 1.5 t or beyond, 4 of 20 of a decade later, falls to 1.5 between
  // these.
  const double end = ed::internal::end_of_ballistic(curve_of(100, brownian));
  const auto power = [](double t) {
    const double next = t * std::pow(10.0, 0.2);
    return std::log(brownian(next) / brownian(t)) / std::log(next / t);
  };
  EXPECT_LE(power(end), 1.5);
  EXPECT_GT(power(end * std::pow(10.0, -0.05)), 1.5);
  EXPECT_TRUE(std::isnan(ed::internal::end_of_ballistic(curve_of(10, [](double t) { return 3 * t * t; }))));
  EXPECT_TRUE(std::isnan(ed::internal::end_of_ballistic({})));
  // From the first lag on, if motion is diffusive there.
  EXPECT_DOUBLE_EQ(ed::internal::end_of_ballistic(curve_of(1, [](double t) { return t; })), 1e-3);
}

TEST(Cage, IsWhereTheMsdIsFlattest) {
  // t^2 at first, a plateau of 0.2 about t = 1, diffusion with 6 D = 0.02 behind.
  const Curve curve = curve_of(100, [](double t) { return caged(t) + 0.02 * t; });
  const ed::internal::Flattest flattest = ed::internal::flattest_of(curve);
  EXPECT_LT(flattest.exponent, 0.3);
  EXPECT_GT(curve.t[flattest.lag], 0.5);
  EXPECT_LT(curve.t[flattest.lag], 3);
  EXPECT_NEAR(curve.y[flattest.lag], 0.2, 0.05);
  EXPECT_NEAR(ed::internal::flattest_of(curve_of(100, brownian)).exponent, 1, 0.02);
  EXPECT_TRUE(std::isnan(ed::internal::flattest_of({{1}, {1}}).exponent));
}

TEST(Diffusion, IsNotACageNorBallisticMotion) {
  EXPECT_EQ(reason_of(ed::internal::why_not_diffusive(curve_of(10, caged), kFluid)), MissingReason::not_displaced);
  EXPECT_EQ(reason_of(ed::internal::why_not_diffusive(curve_of(10, [](double t) { return 3 * t * t; }), kFluid)),
            MissingReason::ballistic);
  // Bodies at rest, and a curve of one lag.
  EXPECT_EQ(reason_of(ed::internal::why_not_diffusive(curve_of(10, [](double) { return 0.0; }), kFluid)),
            MissingReason::not_displaced);
  EXPECT_EQ(reason_of(ed::internal::why_not_diffusive({{1}, {1}}, kFluid)), MissingReason::lags_too_short);
  const auto none = ed::internal::why_not_diffusive({}, kFluid);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->reason, MissingReason::not_measured);
}

TEST(Diffusion, BeginsWhereBodiesHaveLeftTheirCages) {
  // MSD q^2 / 6 = 1 at 0.4 of the longest lag, 20 lags a decade: the first one from there on is 10^-0.35.
  constexpr double kD = 0.02;
  const auto msd = [](double t) { return 6 * kD * t; };
  const double longest = 1 / (kD * 3.5 * 3.5 * std::pow(10.0, -0.35));
  EXPECT_FALSE(ed::internal::why_not_diffusive(curve_of(1.001 * longest, msd), kFluid));
  EXPECT_TRUE(ed::internal::why_not_diffusive(curve_of(0.999 * longest, msd), kFluid));
  EXPECT_NEAR(ed::internal::final_slope(curve_of(longest, msd)), 6 * kD, 1e-12);
}

TEST(Diffusion, IsNotThatOfAFewBodiesAmongOthersThatStay) {
  // A tenth of the bodies diffuses, the others stay: alpha2 = 9, and F_self cannot fall below 0.9.
  constexpr double kShare = 0.1;
  const auto msd = [](double t) { return kShare * 6 * t; };
  const auto first_of = [&](double longest) {
    return curve_of(longest, msd).y[ed::internal::first_of_fit(curve_of(longest, msd))];
  };
  const Reach reach = ed::internal::reach_of_translation(3.5, 1 / kShare - 1);
  const double x = reach.at_start * 3.5 * 3.5 / 6;
  EXPECT_NEAR(std::exp(-x) * (1 + 0.5 * 9 * x * x), std::exp(-1.0), 1e-8);
  EXPECT_GT(x, 4.5);
  const double longest = 4.0 / 0.447 / (0.1 * 3.5 * 3.5);
  ASSERT_GT(first_of(longest), kFluid.at_start);
  EXPECT_FALSE(ed::internal::why_not_diffusive(curve_of(longest, msd), kFluid));
  EXPECT_EQ(reason_of(ed::internal::why_not_diffusive(curve_of(longest, msd), reach)), MissingReason::not_displaced);
  // Gaussian displacements, or narrower ones, ask for nothing more; numbers that are none for all.
  EXPECT_EQ(ed::internal::reach_of_translation(3.5, -0.1).at_start, kFluid.at_start);
  EXPECT_NEAR(ed::internal::reach_of_translation(3.5, 1e-6).at_start, kFluid.at_start, 1e-6);
  EXPECT_TRUE(std::isinf(ed::internal::reach_of_translation(3.5, std::numeric_limits<double>::infinity()).at_start));
}

TEST(Diffusion, IsNotSlowerThanTime) {
  const auto missing =
      ed::internal::why_not_diffusive(curve_of(100, [](double t) { return std::pow(t, 0.7); }), kFluid);
  ASSERT_EQ(reason_of(missing), MissingReason::subdiffusive);
  EXPECT_EQ(ed::describe(*missing), "displacements grow as t^0.7 up to the longest lag: not yet diffusive");
  EXPECT_TRUE(ed::longer_lags_help(missing->reason));
}

TEST(Diffusion, OfRotationIsNotStillFree) {
  // The slope is 1.15 over the fit, and a third of a square radian is passed within it: it may still be free rotation.
  const auto steep = [](double share) {
    return curve_of(1, [share](double t) { return share * 2.0 / 3 * std::pow(t, 1.15); });
  };
  const Reach reach = ed::internal::reach_of_rotation(2);
  EXPECT_EQ(reason_of(ed::internal::why_not_diffusive(steep(1.2), reach)), MissingReason::ballistic);
  EXPECT_FALSE(ed::internal::why_not_diffusive(steep(4), reach));
}

TEST(Diffusion, OfRotationNeedsAThirdOfASquareRadianForEachComponent) {
  constexpr double kD = 0.05;
  for (const double components : {1.0, 2.0, 2.5, 3.0}) {
    const auto turned = [&](double t) { return 2 * components * kD * t; };
    const Reach reach = ed::internal::reach_of_rotation(components);
    const double longest = 1.0 / 3 / (2 * kD);
    EXPECT_FALSE(ed::internal::why_not_diffusive(curve_of(1.001 * longest, turned), reach)) << components;
    const auto missing = ed::internal::why_not_diffusive(curve_of(0.999 * longest, turned), reach);
    ASSERT_EQ(reason_of(missing), MissingReason::not_turned) << components;
    EXPECT_NEAR(missing->reached, std::sqrt(components / 3), 1e-3);
    EXPECT_DOUBLE_EQ(missing->lag, 0.999 * longest);
  }
}

TEST(DecayTime, IsThatOfADecayThatFallsToOneOverE) {
  const auto decay = [](double t) { return std::exp(-t); };
  EXPECT_FALSE(ed::internal::why_no_decay_time(curve_of(3, decay)));
  EXPECT_NEAR(ed::internal::decay_time(curve_of(3, decay)), 1, 1e-3);
  const auto missing = ed::internal::why_no_decay_time(curve_of(0.2, decay));
  ASSERT_EQ(reason_of(missing), MissingReason::not_decayed);
  EXPECT_EQ(ed::describe(*missing), "still 0.82 at the longest lag: not down to 1/e");
  EXPECT_EQ(reason_of(ed::internal::why_no_decay_time(curve_of(3000, decay))), MissingReason::decayed_early);
  EXPECT_TRUE(ed::internal::why_no_decay_time({}));
}

TEST(DecayFit, OfADecayThatGoesOnAfterBallisticMotionIsFound) {
  const Curve curve = curve_of(30, [](double t) { return 0.95 * std::exp(-std::pow(t / 4, 0.8)); });
  const auto found = ed::internal::fit_decay(curve, 0.5);
  ASSERT_TRUE(found);
  EXPECT_FALSE(ed::internal::why_no_fit(curve, 0.5));
  EXPECT_NEAR(found->fit.tau, 4, 1e-6);
  EXPECT_NEAR(found->fit.beta, 0.8, 1e-6);
  EXPECT_GE(found->from, 0.5);
}

TEST(DecayFit, IsNoneWhereItsParametersSayNothing) {
  // Each is a stretched exponential exactly that falls to 1/e at a few time units.
  const auto reason = [](double amplitude, double beta) {
    const Curve curve = curve_of(300, [&](double t) { return amplitude * std::exp(-std::pow(t / 4, beta)); });
    return reason_of(ed::internal::why_no_fit(curve, 0.5));
  };
  EXPECT_EQ(reason(1.31, 0.8), MissingReason::no_fit);
  EXPECT_EQ(reason(1.29, 0.8), MissingReason::not_measured) << "it is one";
  EXPECT_EQ(reason(0.95, 0.28), MissingReason::no_fit);
  EXPECT_EQ(reason(1.19, 0.31), MissingReason::not_measured) << "it is one";
}

TEST(DecayFit, IsNoneWhereASlowerDecayBeginsThatHasNotBeenSeen) {
  // Down to 0.31 at the longest lag. A stretched exponential goes through all lags: amplitude 1.17, tau 0.72, beta
  // 0.63; without the first third of them tau is half as large.
  const auto two = [](double t) { return 0.75 * std::exp(-t / 0.5) + 0.25 * std::exp(-t / 50); };
  const Curve curve = curve_of(1.2, two);
  const auto found = ed::internal::fit_decay(curve, 0.1);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->fit.amplitude, 1.17, 0.01);
  const auto missing = ed::internal::why_no_fit(curve, 0.1);
  ASSERT_EQ(reason_of(missing), MissingReason::tau_unsteady);
  EXPECT_DOUBLE_EQ(missing->reached, curve.y.back());
  EXPECT_EQ(ed::describe(*missing), "still 0.31 at the longest lag: tau depends on the lags that are fitted");
  // A plateau, as that of a nematic.
  const auto plateau = [](double t) { return 0.7 * std::exp(-std::pow(t / 2, 0.7)) + 0.3; };
  EXPECT_EQ(reason_of(ed::internal::why_no_fit(curve_of(8, plateau), 0.1)), MissingReason::tau_unsteady);
}

TEST(DecayFit, OfOneDecayIsSteadyHoweverLittleIsSeenOfIt) {
  for (const double beta : {0.4, 0.7, 1.0, 1.5}) {
    const auto decay = [beta](double t) { return std::exp(-std::pow(t / 4, beta)) * 1.05; };
    EXPECT_FALSE(ed::internal::why_no_fit(curve_of(5, decay), 0.3)) << beta;
  }
  // Two decays that have both been seen, down to 0.08: tau is a mean of theirs.
  const auto two = [](double t) { return 0.8 * std::exp(-t) + 0.2 * std::exp(-t / 5); };
  EXPECT_FALSE(ed::internal::why_no_fit(curve_of(4.5, two), 0.2));
  // Too few lags to leave any out.
  const Curve four{{1, 2, 3, 4}, {0.75, 0.56, 0.42, 0.32}};
  ASSERT_TRUE(ed::internal::fit_decay(four, 1));
  EXPECT_EQ(reason_of(ed::internal::why_no_fit(four, 1)), MissingReason::tau_unsteady);
}

TEST(DecayFit, IsNoneOfPlateausAndOfWhatHasDecayedBefore) {
  const auto crystal = [](double t) { return 0.7 + 0.3 * std::exp(-t * t); };
  EXPECT_EQ(reason_of(ed::internal::why_no_fit(curve_of(100, crystal), 0.5)), MissingReason::not_decayed);
  const auto fast = [](double t) { return std::exp(-t * t); };
  const auto missing = ed::internal::why_no_fit(curve_of(10, fast), 0.5);
  ASSERT_EQ(reason_of(missing), MissingReason::decayed_before_diffusion);
  EXPECT_FALSE(ed::longer_lags_help(missing->reason));
  EXPECT_EQ(reason_of(ed::internal::why_no_fit(curve_of(10, fast), ed::internal::kNothing)),
            MissingReason::end_of_ballistic_unknown);
  EXPECT_EQ(reason_of(ed::internal::why_no_fit(curve_of(10, fast), std::numeric_limits<double>::infinity())),
            MissingReason::no_collisions);
}

TEST(Missing, EveryReasonIsDescribed) {
  for (int k = 0; k <= static_cast<int>(MissingReason::no_director); ++k) {
    const std::string text = ed::describe({static_cast<MissingReason>(k), 0.19, 16});
    EXPECT_FALSE(text.empty()) << k;
    EXPECT_LE(text.size(), 75U) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
  EXPECT_TRUE(ed::longer_lags_help(MissingReason::not_displaced));
  EXPECT_FALSE(ed::longer_lags_help(MissingReason::meaningless));
}

}  // namespace
