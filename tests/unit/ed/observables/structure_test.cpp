// g(r), g2(r) and S(q) of states whose structure is known: ideal gases, lattices, pairs.

#include <common/ed/observed.h>
#include <common/ed/states.h>

#include <observables/structure.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace {

using ed::internal::BodyRange;
using ed::internal::StructureGrid;
using ed::internal::StructureSums;
using ed::internal::WaveVectors;
using ed_test::Inertia;
using Eigen::Vector3d;

/// Points at random in a box, with axes at random.
ed::Snapshot ideal_gas(int number, double box, std::uint64_t seed) {
  ed::Random random(seed);
  ed::Snapshot snapshot;
  for (int i = 0; i < number; ++i) {
    snapshot.position.emplace_back(box * random.uniform(), box * random.uniform(), box * random.uniform());
    snapshot.axis.push_back(random.direction());
  }
  return snapshot;
}

BodyRange all_of(const ed::Snapshot& snapshot) {
  return {0, snapshot.position.size(), false};
}

TEST(Pairs, OfAnIdealGasAreSpreadEvenly) {
  // Both ways of finding pairs: all of them, and in cells.
  for (const int number : {500, 4000}) {
    const StructureGrid grid{20, 1};
    const ed::Snapshot snapshot = ideal_gas(number, grid.box, 1);
    const StructureSums sums = ed::internal::count_pairs(grid, snapshot, {all_of(snapshot)})[0];
    ASSERT_EQ(sums.pairs.size(), 120U);
    for (std::size_t k = 5; k < sums.pairs.size(); k += 5) {
      // Five bins at once: 0.25 wide.
      double pairs = 0, p2 = 0;
      for (std::size_t b = k - 5; b < k; ++b) pairs += sums.pairs[b], p2 += sums.p2[b];
      const double outer = 0.05 * static_cast<double>(k), inner = outer - 0.25;
      const double share = 4 * std::numbers::pi / 3 * (std::pow(outer, 3) - std::pow(inner, 3)) / std::pow(grid.box, 3);
      const double wanted = 0.5 * number * (number - 1) * share;
      EXPECT_LT(std::abs(pairs - wanted), 4 * std::sqrt(wanted) + 1) << number << ", r " << outer;
      // <P2^2> = 1/5.
      EXPECT_LT(std::abs(p2), 4 * std::sqrt(wanted / 5) + 1) << number << ", r " << outer;
    }
  }
}

TEST(Pairs, AreThoseOfADirectCount) {
  for (const int number : {200, 1500}) {
    const StructureGrid grid{13, 1};
    const ed::Snapshot snapshot = ideal_gas(number, grid.box, 2);
    const auto half = static_cast<std::size_t>(number / 2);
    const BodyRange first{0, half, false}, second{half, snapshot.position.size(), false};
    const std::vector<StructureSums> sums = ed::internal::count_pairs(grid, snapshot, {first, second});
    ASSERT_EQ(sums.size(), 4U);
    std::vector<double> direct[4];
    for (auto& d : direct) d.assign(grid.bins(), 0);
    std::vector<double> p2(grid.bins(), 0);
    for (std::size_t i = 0; i < snapshot.position.size(); ++i) {
      for (std::size_t j = i + 1; j < snapshot.position.size(); ++j) {
        Vector3d d = snapshot.position[j] - snapshot.position[i];
        for (int k = 0; k < 3; ++k) d[k] -= grid.box * std::round(d[k] / grid.box);
        const auto bin = static_cast<std::size_t>(d.norm() / grid.reach() * static_cast<double>(grid.bins()));
        if (bin >= grid.bins()) continue;
        direct[0][bin] += 1;
        direct[(i < half) != (j < half) ? 3 : i < half ? 1 : 2][bin] += 1;
        p2[bin] += 1.5 * std::pow(snapshot.axis[i].dot(snapshot.axis[j]), 2) - 0.5;
      }
    }
    for (std::size_t p = 0; p < 4; ++p) EXPECT_EQ(sums[p].pairs, direct[p]) << number << ", part " << p;
    for (std::size_t k = 0; k < grid.bins(); ++k) EXPECT_NEAR(sums[0].p2[k], p2[k], 1e-10) << number;
  }
}

/// Bodies on a simple cubic lattice, all aligned, at rest but for a slow drift in opposite directions.
ed::System cubic(double spacing) {
  ed::System system = ed_test::grid(ed_test::species(2, Inertia::paper), 6, spacing);
  for (ed::Body& body : system.bodies) body.velocity = {1e-9, 0, 0};
  return system;
}

TEST(Structure, OfALatticeIsItsShells) {
  constexpr double kSpacing = 4;
  const ed::System system = cubic(kSpacing);
  const ed::Results results = ed_test::observed(system, ed_test::options_of(system, 1, 0.25));
  // 6 neighbours at 4, 12 at 4 sqrt(2); nothing else below 6.
  double nearest = 0, second = 0, others = 0;
  const double density = system.size() / std::pow(system.box, 3);
  const double half = 0.5 * (results.pairs[1].r - results.pairs[0].r);
  for (const ed::PairRow& row : results.pairs) {
    const double shell = 4 * std::numbers::pi / 3 * (std::pow(row.r + half, 3) - std::pow(row.r - half, 3));
    const double neighbours = row.g.value * density * shell * (system.size() - 1) / system.size();
    const bool first = std::abs(row.r - kSpacing) < 2 * half;
    const bool next = std::abs(row.r - kSpacing * std::sqrt(2)) < 2 * half;
    (first ? nearest : next ? second : others) += neighbours;
    if (row.g.value > 0) {
      EXPECT_NEAR(row.g2.value, 1, 1e-12);
    } else {
      EXPECT_TRUE(std::isnan(row.g2.value));
    }
  }
  EXPECT_NEAR(nearest, 6, 1e-9);
  EXPECT_NEAR(second, 12, 1e-9);
  EXPECT_EQ(others, 0);
  EXPECT_NEAR(results.pairs.back().r + half, 6, 1e-12);
  // Bragg: S(q) = N at the vectors of the reciprocal lattice, six times 2 pi over the box and longer; 0 elsewhere.
  for (const ed::WaveRow& row : results.structure) {
    const double n = row.q * system.box / (2 * std::numbers::pi);
    if (n < 5) {
      EXPECT_NEAR(row.S.value, 0, 1e-9) << n;
    }
  }
  ed::Snapshot snapshot;
  ed::Simulation(system).sample(snapshot);
  const StructureGrid grid{system.box, 1};
  const WaveVectors vectors(grid, 0, 1e9, 1000);
  const std::vector<double> S = vectors.structure_factor(snapshot.position, all_of(snapshot));
  // 3 of the 218 to 234 vectors of length 5.5 to 6.5, one of two opposite ones, are Bragg's.
  EXPECT_NEAR(S[5], 3.0 * system.size() / 226, 0.1);
}

TEST(Structure, FactorIsTheSumOverBodies) {
  const StructureGrid grid{11, 1};
  const ed::Snapshot snapshot = ideal_gas(30, grid.box, 3);
  const BodyRange part{10, 25, false};
  const WaveVectors one(grid, 0, 1e9, 1);
  const std::vector<double> S = one.structure_factor(snapshot.position, part);
  const std::vector<double> q = one.wave_numbers();
  ASSERT_GT(q.size(), 15U);
  // One vector a shell is not told: its length is, and of all vectors of that length some must give this S.
  for (std::size_t shell = 0; shell < q.size(); ++shell) {
    const double n2 = std::pow(q[shell] * grid.box / (2 * std::numbers::pi), 2);
    EXPECT_NEAR(n2, std::round(n2), 1e-9);
    const int most = static_cast<int>(std::sqrt(n2)) + 1;
    double closest = 1e9;
    for (int x = -most; x <= most; ++x) {
      for (int y = -most; y <= most; ++y) {
        for (int z = -most; z <= most; ++z) {
          if (x * x + y * y + z * z != std::lround(n2)) continue;
          double re = 0, im = 0;
          for (std::size_t i = part.begin; i < part.end; ++i) {
            const double phase = 2 * std::numbers::pi / grid.box * Vector3d(x, y, z).dot(snapshot.position[i]);
            re += std::cos(phase), im += std::sin(phase);
          }
          closest = std::min(closest, std::abs((re * re + im * im) / part.size() - S[shell]));
        }
      }
    }
    EXPECT_LT(closest, 1e-10) << shell;
  }
}

TEST(Structure, FactorOfAnIdealGasIsOne) {
  const StructureGrid grid{20, 1};
  const WaveVectors vectors(grid, 0, 1e9, 24);
  constexpr int kFrames = 200;
  std::vector<double> mean(grid.shells(), 0);
  for (int frame = 0; frame < kFrames; ++frame) {
    const ed::Snapshot snapshot = ideal_gas(100, grid.box, static_cast<std::uint64_t>(frame));
    const std::vector<double> S = vectors.structure_factor(snapshot.position, all_of(snapshot));
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += S[k] / kFrames;
  }
  // Exponentially distributed at each of the vectors: 3 in the first shell, 24 in most.
  EXPECT_NEAR(mean[0], 1, 4 / std::sqrt(3.0 * kFrames));
  for (std::size_t k = 3; k < mean.size(); ++k) EXPECT_NEAR(mean[k], 1, 4 / std::sqrt(24.0 * kFrames)) << k;
}

TEST(Structure, FactorOfALargeBoxIsTheSameSum) {
  // The same points in a box a hundred times as large: wave vectors a hundred times as dense, and S(q) is small and
  // smooth where q is below the size of the crowd, |sum|^2 / N close to N.
  const StructureGrid grid{4000, 1};
  const WaveVectors vectors(grid, 0, 1e9, 24);
  for (const int number : {30, 1200}) {
    ed::Snapshot snapshot = ideal_gas(number, 1e-3, 5);
    for (const double S : vectors.structure_factor(snapshot.position, all_of(snapshot)))
      EXPECT_NEAR(S, number, 0.01 * number);
    snapshot = ideal_gas(number, grid.box, 6);
    double mean = 0;
    const std::vector<double> S = vectors.structure_factor(snapshot.position, all_of(snapshot));
    for (const double value : S) mean += value / static_cast<double>(S.size());
    EXPECT_NEAR(mean, 1, 4 / std::sqrt(24.0 * static_cast<double>(S.size())));
  }
}

TEST(Structure, FirstPeakOfAParabolaIsItsTop) {
  std::vector<double> q, S;
  for (int k = 1; k <= 30; ++k) {
    q.push_back(0.3 * k);
    S.push_back(2.5 - 0.7 * std::pow(q.back() - 3.7, 2));
  }
  const ed::internal::Peak peak = ed::internal::first_peak(q, S, 1);
  EXPECT_NEAR(peak.q, 3.7, 1e-12);
  EXPECT_NEAR(peak.S, 2.5, 1e-12);
  // Only where fluids have it.
  S[0] = S[29] = 9;
  EXPECT_NEAR(ed::internal::first_peak(q, S, 1).q, 3.7, 1e-12);
  EXPECT_TRUE(std::isnan(ed::internal::first_peak({}, {}, 1).q));
}

/// Percus and Yevick's, of spheres of diameter 2 at packing fraction eta: Wertheim, Phys. Rev. Lett. 10 (1963) 321.
double percus_yevick(double q, double eta) {
  const double x = 2 * q, s = std::sin(x), c = std::cos(x);
  const double a = std::pow(1 + 2 * eta, 2) / std::pow(1 - eta, 4);
  const double b = -std::pow(1 + eta / 2, 2) / std::pow(1 - eta, 4);
  const double first = a * (s - x * c) / std::pow(x, 3);
  const double second = -6 * eta * b * (x * x * c - 2 * x * s - 2 * c + 2) / std::pow(x, 4);
  const double third = -0.5 * eta * a *
                       ((std::pow(x, 4) - 12 * x * x + 24) * c + (24 * x - 4 * std::pow(x, 3)) * s - 24) /
                       std::pow(x, 6);
  return 1 / (1 + 24 * eta * (first + second + third));
}

TEST(Structure, LikelyPeakIsFoundInNoise) {
  // Percus and Yevick's curve, stretched by some percent, with the scatter of 8 frames: at low density more than the
  // peak is high. At high density it is a parabola's through three shells, half an inverse length apart: 4 % off.
  for (const double eta : {0.1, 0.2, 0.3, 0.45}) {
    for (const double scale : {0.85, 1.0, 1.1}) {
      const StructureGrid grid{std::cbrt(216 * 4 * std::numbers::pi / (3 * eta)), 1};
      const WaveVectors vectors(grid, 1, 8, 100);
      double top = 0;
      for (double q = 2; q < 4.5; q += 0.01) {
        if (percus_yevick(q, eta) > percus_yevick(top == 0 ? 2 : top, eta)) top = q;
      }
      ed::Random random(3);
      double sum = 0, squares = 0;
      constexpr int kRounds = 20;
      for (int round = 0; round < kRounds; ++round) {
        std::vector<double> S;
        for (std::size_t k = 0; k < grid.shells(); ++k) {
          const double q = vectors.wave_numbers()[k];
          const double exact = q > 0 ? percus_yevick(q / scale, eta) : 0;
          const double n = 8 * std::max(1.0, static_cast<double>(vectors.number(k)));
          S.push_back(exact * (1 + random.normal() / std::sqrt(n)));
        }
        const double x = ed::internal::likely_peak(vectors, S, 8, grid, eta) / (scale * top) - 1;
        sum += x / kRounds;
        squares += x * x / kRounds;
      }
      EXPECT_LT(std::sqrt(squares), eta < 0.4 ? 0.04 : 0.05) << eta << " " << scale;
      EXPECT_LT(std::abs(sum), eta < 0.4 ? 0.02 : 0.05) << eta << " " << scale;
    }
  }
}

TEST(Structure, LikelyPeakIsThatOfSpheresWhereNothingIsKnown) {
  // An ideal gas: S(q) is 1 everywhere.
  const StructureGrid grid{20, 1};
  const WaveVectors vectors(grid, 1, 8, 100);
  const std::vector<double> S(grid.shells(), 1.0);
  EXPECT_NEAR(ed::internal::likely_peak(vectors, S, 8, grid, 0.01), 2.89, 0.01);
  // Of another size of bodies.
  const StructureGrid twice{40, 2};
  const WaveVectors halves(twice, 0.5, 4, 100);
  EXPECT_NEAR(ed::internal::likely_peak(halves, S, 8, twice, 0.01), 1.445, 0.005);
}

TEST(Structure, LikelyPeakIsTheClearOneThatIsThere) {
  // That of no fluid.
  const StructureGrid grid{20, 1};
  const WaveVectors vectors(grid, 1, 8, 100);
  std::vector<double> S;
  for (const double q : vectors.wave_numbers()) S.push_back(1 + 3 / (1 + (q - 5.5) * (q - 5.5) / 0.16));
  EXPECT_NEAR(ed::internal::likely_peak(vectors, S, 8, grid, 0.45), 5.5, 0.1);
}

TEST(Structure, OfSpheresIsPercusAndYevicks) {
  constexpr double kPhi = 0.3;
  const ed::System system = ed_test::equilibrated({1, kPhi, 500, Inertia::paper, 7}, 5);
  const ed::Results results = ed_test::observed(system, ed_test::options_of(system, 64, 1));
  const double half = std::numbers::pi / system.box;  // of a shell
  double highest = 0, at = 0;
  for (double q = 2; q < 5; q += 0.01) {
    if (percus_yevick(q, kPhi) > highest) highest = percus_yevick(at = q, kPhi);
  }
  for (const ed::WaveRow& row : results.structure) {
    if (row.q < 1) continue;  // few vectors, S(q) below 0.1
    // Simpson's mean over the shell. The theory is good to some percent.
    const double wanted =
        (percus_yevick(row.q - half, kPhi) + 4 * percus_yevick(row.q, kPhi) + percus_yevick(row.q + half, kPhi)) / 6;
    EXPECT_NEAR(row.S.value, wanted, 0.05 * wanted + 4 * row.S.error) << row.q;
    EXPECT_LT(row.S.error, 0.05 * wanted);
  }
  EXPECT_NEAR(results.q_peak.value, at, 0.1);
  for (const double q : {1.0, 1.5, 3.2, 7.0}) {
    EXPECT_NEAR(ed::internal::percus_yevick(q, kPhi), percus_yevick(q, kPhi), 1e-10) << q;
  }
  EXPECT_NEAR(results.S_peak.value, highest, 0.07 * highest);
  EXPECT_NEAR(ed::structure_peak(system), at, 0.5);
}

/// S(q) of a gas is 1 to within its scatter: its highest value is chance, at another wave number with every seed.
TEST(StructurePeak, OfAGasIsMissing) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const ed::System system = ed_test::start({1, 0.005, 64, Inertia::paper, seed});
    const ed::Results gas = ed_test::observed(system, ed_test::options_of(system, 64, 1));
    for (const ed::Estimate& peak : {gas.q_peak, gas.S_peak}) {
      EXPECT_TRUE(std::isnan(peak.value)) << peak.value;
      EXPECT_EQ(peak.missing.reason, ed::MissingReason::no_peak);
    }
    EXPECT_FALSE(gas.structure.empty());
  }
}

/// S(q) of a thin fluid rises to 1.18: less than scatter allows for in 32 configurations, but blocks of many frames
/// scatter less.
TEST(StructurePeak, OfAThinFluidIsThatOfPercusAndYevick) {
  constexpr double kPhi = 0.15;
  const ed::System system = ed_test::equilibrated({1, kPhi, 256, Inertia::paper, 9}, 5);
  const ed::Results results = ed_test::observed(system, ed_test::options_of(system, 200, 1));
  double highest = 0, at = 0;
  for (double q = 2; q < 5; q += 0.01) {
    if (percus_yevick(q, kPhi) > highest) highest = percus_yevick(at = q, kPhi);
  }
  ASSERT_LT(highest, 1.22);
  EXPECT_NEAR(results.S_peak.value, highest, 0.02 + 4 * results.S_peak.error);
  EXPECT_NEAR(results.q_peak.value, at, 4 * results.q_peak.error);
  EXPECT_LT(results.q_peak.error, 0.3);
}

TEST(Pairs, OfSpheresTouchAsOftenAsCarnahanAndStarlingSay) {
  constexpr double kPhi = 0.3;
  const ed::System system = ed_test::equilibrated({1, kPhi, 500, Inertia::paper, 8}, 5);
  const ed::Results results = ed_test::observed(system, ed_test::options_of(system, 64, 1));
  std::vector<ed::PairRow> beyond;
  for (const ed::PairRow& row : results.pairs) {
    if (row.r > 2) {
      beyond.push_back(row);
    } else {
      EXPECT_EQ(row.g.value, 0) << row.r;
    }
  }
  // The parabola through the first three bins, at their edge.
  const double contact = 1.875 * beyond[0].g.value - 1.25 * beyond[1].g.value + 0.375 * beyond[2].g.value;
  const double error = 1.875 * beyond[0].g.error + 1.25 * beyond[1].g.error + 0.375 * beyond[2].g.error;
  EXPECT_NEAR(contact, (1 - kPhi / 2) / std::pow(1 - kPhi, 3), 3 * error);
  EXPECT_LT(error, 0.1);
}

}  // namespace
