// Correlations of fluids where theory knows them, and whether the error bars are as large as they say.

#include <common/ed/observed.h>
#include <common/ed/reference.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace {

using ed_test::Inertia;
using ed_test::observed;
using ed_test::options_of;

TEST(VelocityCorrelation, OfSpheresStartsWithEnskogsSlope) {
  // At short times C(t) / C(0) = 1 - 2 Gamma t / 3 at any density, Gamma the collision rate of a sphere: velocities
  // before a collision are uncorrelated then (Enskog; Hansen and McDonald, Theory of Simple Liquids, sec. 7.2). In a
  // dilute gas exp(-2 Gamma t / 3) holds much longer, but for Sonine corrections of a percent.
  for (const double phi : {0.02, 0.3}) {
    const ed::System system = ed_test::equilibrated({1, phi, 512, Inertia::paper, 71}, 10);
    const double duration = phi < 0.1 ? 600 : 120;
    const ed::Results results = observed(system, options_of(system, duration, phi < 0.1 ? 10 : 1));
    const double rate = 2 * results.collision_rate.value / 3;
    int compared = 0;
    for (const ed::LagRow& row : results.lags) {
      const double x = rate * row.lag;
      // Where the second order is below a percent of the first, and the first stands out.
      if (x > 0.02 || x < 0.005) continue;
      const double fall = 1 - row.vacf.value / results.v2.value;
      const double error = row.vacf.error / results.v2.value;
      EXPECT_LE(std::abs(fall - (1 - std::exp(-x))), 4 * error + 0.01 * x) << "phi " << phi << ", x " << x;
      EXPECT_LT(error, 0.05 * x);
      ++compared;
    }
    EXPECT_GT(compared, 5) << phi;
    for (const ed::LagRow& row : results.lags) {
      const double x = rate * row.lag;
      if (phi > 0.1 || x < 0.02 || x > 1) continue;
      EXPECT_LE(std::abs(row.vacf.value / results.v2.value - std::exp(-x)), 4 * row.vacf.error / 3 + 0.02 * x) << x;
    }
  }
}

TEST(FreeRotor, FirstCorrelationIsKnown) {
  const ed_test::ReferenceTable table("free_rotor_c2.csv");
  const struct {
    double aspect_ratio;
    Inertia inertia;
    const char* column;
  } cases[] = {{3, Inertia::paper, "C1_linear"}, {1, Inertia::uniform, "C1_spherical_top"}};
  for (const auto& c : cases) {
    const ed::System system = ed_test::maxwellian_gas(ed_test::species(c.aspect_ratio, c.inertia), 30, 100, 64);
    const double unit = std::sqrt(system.species[0].inertia.x());
    ed::ObservablesOptions options = options_of(system, 6 * unit, 6 * unit);
    const ed::Results results = observed(system, options);
    // Of one cosine of N bodies.
    const double error = std::sqrt(0.5 / system.size());
    int compared = 0;
    for (const ed::LagRow& row : results.lags) {
      const double tau = row.lag / unit;
      const double below = std::floor(tau / 0.05) * 0.05;
      if (tau < 0.3 || below + 0.05 > 6) continue;
      const auto at = [&](double x) { return table.at({{"tau=t*sqrt(kT/I)", std::round(x * 20) / 20}}, c.column); };
      // Linear between rows 0.05 apart: off by at most 0.05^2 / 8.
      const double wanted = at(below) + (tau - below) / 0.05 * (at(below + 0.05) - at(below));
      EXPECT_NEAR(row.c1.value, wanted, 4 * error + 3.2e-4) << c.column << " " << tau;
      ++compared;
    }
    EXPECT_GT(compared, 20);
  }
}

TEST(Pressure, OfAFluidIsIsotropic) {
  for (const double aspect_ratio : {1.0, 3.0}) {
    const ed::System system = ed_test::equilibrated({aspect_ratio, 0.3, 256, Inertia::paper, 72}, 20);
    const ed::Results results = observed(system, options_of(system, 64, 2));
    const ed::TensorEstimate& P = results.pressure;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double wanted = i == j ? results.Z.value : 0;
        EXPECT_LE(std::abs(P.value(i, j) - wanted), 4 * P.error(i, j)) << aspect_ratio << ": " << i << j;
        EXPECT_LT(P.error(i, j), 0.02 * results.Z.value);
        EXPECT_GT(P.error(i, j), 0);
      }
    }
  }
}

// ---- Errors --------------------------------------------------------------------------------------------------------

/// The scatter of a quantity between runs that differ in their seed alone, over the error that they state.
double scatter_over_error(const std::vector<ed::Results>& runs,
                          const std::function<ed::Estimate(const ed::Results&)>& of) {
  double mean = 0;
  double stated = 0;
  const auto n = static_cast<double>(runs.size());
  for (const ed::Results& r : runs) {
    mean += of(r).value / n;
    stated += of(r).error * of(r).error / n;
  }
  double scatter = 0;
  for (const ed::Results& r : runs) scatter += std::pow(of(r).value - mean, 2) / (n - 1);
  return std::sqrt(scatter / stated);
}

TEST(Errors, AreTheScatterBetweenRuns) {
  constexpr int kRuns = 20;
  constexpr double q = 4;
  std::vector<ed::Results> runs;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const ed::System system =
        ed_test::equilibrated({2, 0.35, 64, Inertia::paper, static_cast<std::uint64_t>(seed)}, 20);
    // Lags so long that the mean square displacement is linear in every run, or some would not state a D.
    runs.push_back(observed(system, options_of(system, 192, 6, {q})));
  }
  const auto lag = [](double t) {
    return [t](const ed::Results& r) -> const ed::LagRow& {
      return *std::find_if(r.lags.begin(), r.lags.end(), [t](const ed::LagRow& row) { return row.lag > t; });
    };
  };
  const struct {
    std::string name;
    std::function<ed::Estimate(const ed::Results&)> of;
  } quantities[] = {
      {"Z", [](const ed::Results& r) { return r.Z; }},
      {"collision rate", [](const ed::Results& r) { return r.collision_rate; }},
      {"D_trans", [](const ed::Results& r) { return r.D_trans; }},
      {"D_rot", [](const ed::Results& r) { return r.D_rot; }},
      {"MSD", [&](const ed::Results& r) { return lag(1)(r).msd; }},
      {"C1", [&](const ed::Results& r) { return lag(0.5)(r).c1; }},
      {"C2", [&](const ed::Results& r) { return lag(0.5)(r).c2; }},
      {"VACF", [&](const ed::Results& r) { return lag(0.1)(r).vacf; }},
      {"angular VACF", [&](const ed::Results& r) { return lag(0.1)(r).wacf; }},
      {"alpha2", [&](const ed::Results& r) { return lag(0.3)(r).alpha2; }},
      {"F_self", [&](const ed::Results& r) { return lag(0.5)(r).f_self[0]; }},
      {"t_F", [](const ed::Results& r) { return r.t_F_1overe; }},
      {"P_xy",
       [](const ed::Results& r) {
         return ed::Estimate{r.pressure.value(0, 1), r.pressure.error(0, 1)};
       }},
  };
  for (const auto& quantity : quantities) {
    const double ratio = scatter_over_error(runs, quantity.of);
    std::printf("scatter of %d runs over the error they state, %s: %.2f\n", kRuns, quantity.name.c_str(), ratio);
    // A standard deviation of 20 values is known to 1 / sqrt(2 x 19) = 0.16; the errors stated add a tenth to that.
    EXPECT_GT(ratio, 1 - 3 * 0.18) << quantity.name;
    EXPECT_LT(ratio, 1 + 3 * 0.18) << quantity.name;
  }
}

}  // namespace
