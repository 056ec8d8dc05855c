// Mixtures and collective motion: structure of each two species against sums over pairs and wave vectors, spheres
// without orientation, masses and alpha_2, F(q, t) / S(q) of known motion, and the same bits after a restart.

#include <common/ed/observed.h>
#include <common/ed/states.h>

#include <ed/ed.h>
#include <ed/random.h>
#include <ed/stored_frames.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kEdge = 10;
/// Rounding of sums of some thousand terms of order 1.
constexpr double kCrossRounding = 1e-10;

/// Frames of points at random that move freely, with axes at random.
std::vector<ed::StoredFrame> free_points(int number, std::size_t frames, std::uint64_t seed) {
  ed::Random random(seed);
  ed::StoredFrame first;
  for (int i = 0; i < number; ++i) {
    first.position.push_back(kEdge * Vector3d(random.uniform(), random.uniform(), random.uniform()));
    first.rotation.push_back(random.rotation());
    first.velocity.push_back(random.normal3());
  }
  std::vector<ed::StoredFrame> list;
  for (std::size_t k = 0; k < frames; ++k) {
    ed::StoredFrame frame = first;
    frame.time = 0.125 * static_cast<double>(k);
    for (std::size_t i = 0; i < frame.position.size(); ++i) frame.position[i] += first.velocity[i] * frame.time;
    list.push_back(frame);
  }
  return list;
}

ed::StoredFramesOptions options_of_points(const std::vector<ed::BodyGroup>& groups) {
  ed::StoredFramesOptions options;
  options.box = kEdge;
  options.groups = groups;
  for (const ed::BodyGroup& group : groups)
    options.axis.insert(options.axis.end(), static_cast<std::size_t>(group.number), 2);
  options.wave_numbers = {1.3, 2.5};
  return options;
}

std::complex<double> amplitude(const std::vector<Vector3d>& positions, std::size_t begin, std::size_t end,
                               const Vector3i& n) {
  std::complex<double> sum;
  for (std::size_t i = begin; i < end; ++i) {
    sum += std::polar(1.0, 2 * std::numbers::pi / kEdge * n.cast<double>().dot(positions[i]));
  }
  return sum;
}

/// Vectors of lengths from..to in 2 pi / box, both signs.
std::vector<Vector3i> vectors_between(double from, double to) {
  std::vector<Vector3i> list;
  const int most = static_cast<int>(to) + 1;
  for (int x = -most; x <= most; ++x) {
    for (int y = -most; y <= most; ++y) {
      for (int z = -most; z <= most; ++z) {
        const double size = Vector3i(x, y, z).cast<double>().norm();
        if (size > 0 && size >= from && size < to) list.emplace_back(x, y, z);
      }
    }
  }
  return list;
}

const std::vector<ed::BodyGroup> kThreeGroups = {{30, 2}, {50, 3}, {20, 2}};

TEST(Mixtures, StructureOfTwoSpeciesIsThatOfADirectSum) {
  const std::vector<ed::StoredFrame> frames = free_points(100, 3, 11);
  const ed::StoredResults results = ed::analyze_frames(frames, options_of_points(kThreeGroups));
  ASSERT_EQ(results.crosses.size(), 3U);
  const std::size_t first[] = {0, 30, 80};
  const std::size_t end[] = {30, 80, 100};
  const double width = results.pairs[1].r - results.pairs[0].r;
  // The first shell has fewer vectors than are drawn: all of them.
  const std::vector<Vector3i> shell = vectors_between(0.5, 1.5);
  for (const ed::CrossStructure& cross : results.crosses) {
    const auto a = static_cast<std::size_t>(cross.a);
    const auto b = static_cast<std::size_t>(cross.b);
    std::vector<double> count(cross.pairs.size(), 0);
    double S = 0;
    for (const ed::StoredFrame& frame : frames) {
      for (std::size_t i = first[a]; i < end[a]; ++i) {
        for (std::size_t j = first[b]; j < end[b]; ++j) {
          Vector3d d = frame.position[j] - frame.position[i];
          for (int k = 0; k < 3; ++k) d[k] -= kEdge * std::round(d[k] / kEdge);
          const auto bin = static_cast<std::size_t>(d.norm() / width);
          if (bin < count.size()) count[bin] += 1;
        }
      }
      for (const Vector3i& n : shell) {
        S +=
            (amplitude(frame.position, first[a], end[a], n) * std::conj(amplitude(frame.position, first[b], end[b], n)))
                .real() /
            static_cast<double>(shell.size() * frames.size());
      }
    }
    const auto pairs = static_cast<double>((end[a] - first[a]) * (end[b] - first[b]));
    for (std::size_t k = 0; k < count.size(); ++k) {
      const double inner = width * static_cast<double>(k);
      const double share =
          4 * std::numbers::pi / 3 * (std::pow(inner + width, 3) - std::pow(inner, 3)) / std::pow(kEdge, 3);
      EXPECT_NEAR(cross.pairs[k].g.value * 3 * pairs * share, count[k], 1e-8) << cross.a << cross.b << " bin " << k;
    }
    EXPECT_NEAR(cross.structure[0].S.value, S / std::sqrt(pairs), kCrossRounding);
  }
}

TEST(Mixtures, StructureOfAllIsTheSumOverSpecies) {
  const ed::StoredResults results = ed::analyze_frames(free_points(100, 5, 12), options_of_points(kThreeGroups));
  const double share[] = {0.3, 0.5, 0.2};
  for (std::size_t k = 0; k < results.structure.size(); ++k) {
    double sum = 0;
    for (std::size_t g = 0; g < 3; ++g) sum += share[g] * results.groups[g].structure[k].S.value;
    for (const ed::CrossStructure& c : results.crosses) {
      sum += 2 * std::sqrt(share[c.a] * share[c.b]) * c.structure[k].S.value;
    }
    EXPECT_NEAR(sum, results.structure[k].S.value, kCrossRounding) << results.structure[k].q;
  }
  for (std::size_t k = 0; k < results.pairs.size(); ++k) {
    // Numbers of pairs over those of an ideal gas: 100 * 99 / 2 in all.
    double sum = 0;
    const double number[] = {30, 50, 20};
    for (std::size_t g = 0; g < 3; ++g) sum += number[g] * (number[g] - 1) / 2 * results.groups[g].pairs[k].g.value;
    for (const ed::CrossStructure& c : results.crosses) sum += number[c.a] * number[c.b] * c.pairs[k].g.value;
    EXPECT_NEAR(sum / 4950, results.pairs[k].g.value, kCrossRounding);
  }
}

TEST(Mixtures, ManySpeciesHaveNoCrossStructure) {
  const std::vector<ed::BodyGroup> groups(ed::kMostCrossedSpecies + 1, {10, 2});
  const ed::StoredResults results = ed::analyze_frames(free_points(90, 2, 13), options_of_points(groups));
  EXPECT_EQ(results.groups.size(), groups.size());
  EXPECT_TRUE(results.crosses.empty());
}

TEST(Mixtures, SpheresCountForNoOrientation) {
  const std::vector<ed::StoredFrame> frames = free_points(100, 9, 14);
  const ed::StoredResults with =
      ed::analyze_frames(frames, options_of_points({{60, 2, true}, {30, 2, false}, {10, 3, true}}));
  std::vector<ed::StoredFrame> alone = frames;
  for (ed::StoredFrame& frame : alone) {
    for (auto* list : {&frame.position, &frame.velocity}) list->erase(list->begin() + 60, list->begin() + 90);
    frame.rotation.erase(frame.rotation.begin() + 60, frame.rotation.begin() + 90);
  }
  const ed::StoredResults without = ed::analyze_frames(alone, options_of_points({{60, 2}, {10, 3}}));
  EXPECT_NEAR(with.S.value, without.S.value, kCrossRounding);
  EXPECT_NEAR(with.director.axis.dot(without.director.axis), 1, kCrossRounding);
  ASSERT_EQ(with.lags.size(), without.lags.size());
  for (std::size_t k = 0; k < with.lags.size(); ++k) {
    EXPECT_NEAR(with.lags[k].c1.value, without.lags[k].c1.value, kCrossRounding);
    EXPECT_NEAR(with.lags[k].c2.value, without.lags[k].c2.value, kCrossRounding);
    EXPECT_GT(std::abs(with.lags[k].msd.value - without.lags[k].msd.value), 1e-6);
  }
  for (std::size_t k = 0; k < with.pairs.size(); ++k) {
    if (std::isfinite(with.pairs[k].g2.value)) {
      EXPECT_NEAR(with.pairs[k].g2.value, without.pairs[k].g2.value, kCrossRounding);
    }
    EXPECT_EQ(with.groups[1].pairs[k].g2.missing.reason, ed::MissingReason::no_orientation);
    EXPECT_TRUE(std::isnan(with.crosses[0].pairs[k].g2.value));
  }
  EXPECT_EQ(with.groups[1].S.missing.reason, ed::MissingReason::no_orientation);
  EXPECT_EQ(with.groups[1].t_C2_1overe.missing.reason, ed::MissingReason::no_orientation);
  EXPECT_TRUE(std::isfinite(with.groups[0].S.value));
}

/// Velocities with <v^2> = 3 kT/m and <v^4> = 15 (kT/m)^2 of each mass, as Maxwell's: 2 of 5 bodies at rest, 3 at
/// v^2 = 5 kT/m. alpha_2 = 3 <v^4> / (5 <v^2>^2) - 1 = <1/m^2> / <1/m>^2 - 1 then, at all lags of free flight.
TEST(Mixtures, MassesThatDifferMakeShortDisplacementsNonGaussian) {
  ed::Random random(15);
  std::vector<ed::StoredFrame> frames(9);
  double inverse = 0, inverse2 = 0;
  for (int i = 0; i < 100; ++i) {
    const double size = 0.7 + 0.2 * (i / 25);  // four sizes, of density 1
    const double mass = size * size * size;
    inverse += 0.01 / mass;
    inverse2 += 0.01 / (mass * mass);
    const double speed = i % 5 < 2 ? 0 : std::sqrt(5 / mass);
    const Vector3d velocity = speed * random.direction();
    for (std::size_t k = 0; k < frames.size(); ++k) {
      frames[k].time = 0.01 * static_cast<double>(k);
      frames[k].position.emplace_back(velocity * frames[k].time);
    }
  }
  const ed::StoredResults results = ed::analyze_frames(frames, options_of_points({{100, 2}}));
  const double wanted = inverse2 / (inverse * inverse) - 1;
  EXPECT_GT(wanted, 0.2);
  for (const ed::LagRow& row : results.lags) EXPECT_NEAR(row.alpha2.value, wanted, 1e-9) << row.lag;
}

TEST(Collective, IsThatOfADirectSum) {
  const std::vector<ed::StoredFrame> frames = free_points(80, 21, 16);
  ed::StoredFramesOptions options = options_of_points({{30, 2}, {50, 2}});
  // 2.07 and 3.98 in 2 pi / box: 31 and more than 48 vectors in the shells, and one that no vector has.
  options.wave_numbers = {1.3, 0.2};
  options.collective = true;
  const ed::StoredResults results = ed::analyze_frames(frames, options);
  ASSERT_EQ(results.decays_collective.size(), 2U);
  const std::vector<Vector3i> shell =
      vectors_between(1.3 * kEdge / (2 * std::numbers::pi) - 0.5, 1.3 * kEdge / (2 * std::numbers::pi) + 0.5);
  ASSERT_LE(shell.size() / 2, 48U);
  for (const ed::LagRow& row : results.lags) {
    const auto lag = static_cast<std::size_t>(std::lround(row.lag / 0.125));
    double later = 0, at_once = 0;
    for (std::size_t k = 0; k + lag < frames.size(); ++k) {
      for (const Vector3i& n : shell) {
        const std::complex<double> before = amplitude(frames[k].position, 0, 80, n);
        later += (before * std::conj(amplitude(frames[k + lag].position, 0, 80, n))).real();
        at_once += std::norm(before);
      }
    }
    EXPECT_NEAR(row.f_collective[0].value, later / at_once, kCrossRounding) << row.lag;
    EXPECT_TRUE(std::isnan(row.f_collective[1].value));
  }
  EXPECT_EQ(results.decays_collective[1].t_1overe.missing.reason, ed::MissingReason::no_wave_vector);
  EXPECT_TRUE(results.groups[0].decays_collective.empty());
}

TEST(Collective, TakesSomeVectorsOfALargeShell) {
  ed::StoredFramesOptions options = options_of_points({{400, 2}});
  options.wave_numbers = {6, 30};  // the second is beyond the shells that are listed
  options.collective = true;
  const ed::StoredResults results = ed::analyze_frames(free_points(400, 41, 17), options);
  // Free points: F = exp(-(q t)^2 / 2) at v = 1, to the scatter of 48 vectors and 32 origins that are not independent.
  const ed::LagRow& row = results.lags[1];
  EXPECT_NEAR(row.f_collective[0].value, std::exp(-std::pow(6 * row.lag, 2) / 2), 5 / std::sqrt(48.0));
  EXPECT_TRUE(std::isfinite(row.f_collective[1].value));
}

/// Ellipsoids, and spheres of another mass, that collide.
ed::System rods_and_spheres() {
  ed::System system = ed_test::grid(ed_test::species(2, ed_test::Inertia::paper), 4, 3.3);
  ed::Species sphere = ed::uniform_species(geom::Ellipsoid({0.8, 0.8, 0.8}), 2);
  system.species.push_back(sphere);
  ed::Random random(18);
  for (int i = 0; i < system.size(); ++i) {
    ed::Body& body = system.bodies[static_cast<std::size_t>(i)];
    body.species = i < 40 ? 0 : 1;
    body.rotation = random.rotation();
    body.velocity = random.normal3();
  }
  return system;
}

TEST(Collective, RestoredObservablesMeasureTheSameBits) {
  const ed::System system = rods_and_spheres();
  ed::ObservablesOptions options = ed_test::options_of(system, 8, 2, {2.0, 4.0});
  options.groups = {{40, 2}, {24, 2, false}};
  options.collective = true;
  const auto run = [&](double saved_at) {
    ed::Simulation simulation(system);
    ed::Observables observables(options);
    while (observables.next_time() <= options.duration) {
      simulation.run_until(observables.next_time());
      observables.measure(simulation);
      if (simulation.time() < saved_at) continue;
      saved_at = 2 * options.duration;
      observables = ed::Observables::restore(observables.save(), options);
    }
    EXPECT_GT(simulation.counters().collisions, 50U);
    return observables.save();
  };
  EXPECT_EQ(run(3.1), run(2 * options.duration));
}

}  // namespace
