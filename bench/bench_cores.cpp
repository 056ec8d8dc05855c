/// Time of one cold distance query of spheres, capsules, boxes, polyhedra, cylinders and cones, beside the primitives
/// of FCL and Coal at their default tolerances (where they are built in), on the same pairs: a table of medians of ns,
/// their ratios, and the largest errors.
///
/// usage: bench_cores [GAP]
///
/// Distances are known by construction (tests/common/geom/core_pairs.h), GAP apart (0.3). A failure is an answer that
/// is declined, or wrong by more than 1e-13 of the pair's size; it is counted, not hidden.

#include "common/geom/core_pairs.h"

#include <geom/geom.h>

#ifdef HARDBODY_WITH_SEEDS
#include "oracle/fcl_raw.h"
#endif
#ifdef HARDBODY_WITH_COAL
#include "oracle/coal_raw.h"
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using geom_test::Random;

constexpr std::size_t kPairs = 512;
constexpr int kRounds = 41;

/// Returns the median over some rounds of the time of one call, in ns.
template <class Call>
double median_time(std::size_t calls, const Call& call) {
  std::vector<double> times;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < calls; ++k) call(k);
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - begin;
    times.push_back(time.count() / static_cast<double>(calls));
  }
  std::nth_element(times.begin(), times.begin() + kRounds / 2, times.end());
  return times[kRounds / 2];
}

/// Prints another library's time, error, and our time over its.
template <class Primitives, class A, class B, class Distance>
void beside(const A& a, const B& b, const std::vector<geom_test::ManufacturedPair>& pairs, double gap, double ours,
            const Distance& distance) {
  std::vector<Primitives> theirs;
  for (const auto& pair : pairs) theirs.emplace_back(a.core(), pair.X_WA, b.core(), pair.X_WB);
  double error = 0;
  double sum = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    error = std::max(error, std::abs(distance(theirs[k]) - gap) / geom_test::extent_of(pairs[k]));
  }
  const double time = median_time(pairs.size() / 8, [&](std::size_t k) { sum += distance(theirs[k]); });
  std::printf(" %.0f | %.1e | %.2f |%s", time, error, ours / time, std::isnan(sum) ? " (declined)" : "");
}

template <class A, class B>
void row(const char* name, const A& a, const B& b, double gap) {
  Random random(1);
  std::vector<geom_test::ManufacturedPair> pairs;
  for (std::size_t k = 0; k < kPairs; ++k) {
    pairs.push_back(
        geom_test::manufacture_features(a, static_cast<int>(k % 3), b, static_cast<int>(k / 3 % 3), gap, random));
  }
  double sum = 0;
  const double ours =
      median_time(kPairs, [&](std::size_t k) { sum += geom::distance(a, pairs[k].X_WA, b, pairs[k].X_WB).distance; });
  double error = 0;
  int failures = 0;
  for (const auto& pair : pairs) {
    const geom::DistanceResult r = geom::distance(a, pair.X_WA, b, pair.X_WB);
    const double relative = std::abs(r.distance - gap) / geom_test::extent_of(pair);
    if (!(relative <= 1e-13)) ++failures;
    error = std::max(error, relative);
  }
  std::printf("| %s | %.0f | %.1e | %d |", name, ours, error, failures);
#ifdef HARDBODY_WITH_SEEDS
  beside<geom_test::FclPrimitives>(a, b, pairs, gap, ours, [](const auto& p) { return p.distance().distance; });
#endif
#ifdef HARDBODY_WITH_COAL
  beside<geom_test::CoalPrimitives>(a, b, pairs, gap, ours, [](const auto& p) { return p.distance(); });
#endif
  std::printf("%s\n", std::isnan(sum) ? " (declined)" : "");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const double gap = argc > 1 ? std::atof(argv[1]) : 0.3;
  std::printf("gap %g, 512 pairs a row, features of all kinds; ratios are our time over theirs\n", gap);
  const char* const libraries[] = {
#ifdef HARDBODY_WITH_SEEDS
      "FCL",
#endif
#ifdef HARDBODY_WITH_COAL
      "Coal",
#endif
      nullptr};
  std::printf("| pair | ns | largest error | failures |");
  for (const char* const* name = libraries; *name != nullptr; ++name) {
    std::printf(" %s, ns | %s, largest error | ratio |", *name, *name);
  }
  std::printf("\n|---|---|---|---|");
  for (const char* const* name = libraries; *name != nullptr; ++name) std::printf("---|---|---|");
  std::printf("\n");
  const geom::Sphere sphere(0.7);
  const geom::Capsule capsule(1, 0.5);
  const geom::Box box({0.5, 0.8, 1.1});
  row("sphere, sphere", sphere, sphere, gap);
  row("sphere, capsule", sphere, capsule, gap);
  row("capsule, capsule", capsule, capsule, gap);
  row("sphere, box", sphere, box, gap);
  row("capsule, box", capsule, box, gap);
  row("box, box", box, box, gap);
  const geom::Cylinder cylinder(1, 0.5);
  const geom::Cone cone(1.5, 0.8);
  row("cylinder, cylinder", cylinder, cylinder, gap);
  row("sphere, cylinder", sphere, cylinder, gap);
  row("capsule, cylinder", capsule, cylinder, gap);
  row("box, cylinder", box, cylinder, gap);
  row("cone, cone", cone, cone, gap);
  row("sphere, cone", sphere, cone, gap);
  row("box, cone", box, cone, gap);
  Random random(3);
  for (const int points : {8, 32, 100}) {
    const geom::ConvexPolyhedron hull = geom_test::random_polyhedron(points, random);
    char name[64];
    (void)std::snprintf(name, sizeof name, "hull, hull of %d points", points);
    row(name, hull, hull, gap);
    (void)std::snprintf(name, sizeof name, "sphere, hull of %d points", points);
    row(name, sphere, hull, gap);
    (void)std::snprintf(name, sizeof name, "capsule, hull of %d points", points);
    row(name, capsule, hull, gap);
    (void)std::snprintf(name, sizeof name, "box, hull of %d points", points);
    row(name, box, hull, gap);
  }
}
