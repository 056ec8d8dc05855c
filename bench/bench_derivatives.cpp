/// Time of the derivatives of a distance, beside that of the distance: medians in ns and their ratio, for pairs of each
/// kind of shape and an ellipsoid, and of each kind with itself, apart.
///
/// usage: bench_derivatives

#include "common/geom/random.h"

#include <geom/geom.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr std::size_t kPairs = 256;
constexpr int kRounds = 41;

/// Returns the median over some rounds of the time of one call, in ns.
template <class Call>
double median_time(const Call& call) {
  std::vector<double> times;
  for (int round = 0; round < kRounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < kPairs; ++k) call(k);
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - begin;
    times.push_back(time.count() / static_cast<double>(kPairs));
  }
  std::nth_element(times.begin(), times.begin() + kRounds / 2, times.end());
  return times[kRounds / 2];
}

void print_row(const std::string& name, const geom::Shape& a, const geom::Shape& b) {
  geom_test::Random random(1);
  std::vector<geom::Pose> X_WA, X_WB;
  const double reach = geom::bounding_radius(a) + geom::bounding_radius(b);
  for (std::size_t k = 0; k < kPairs; ++k) {
    X_WA.push_back(random.pose(1.0));
    X_WB.push_back(random.pose(X_WA[k].position() + 1.2 * reach * random.direction()));
  }
  std::vector<geom::DistanceResult> at(kPairs);
  std::vector<geom::DistanceDerivatives> found(kPairs);
  const double distances = median_time([&](std::size_t k) { at[k] = geom::distance(a, X_WA[k], b, X_WB[k]); });
  const double derivatives =
      median_time([&](std::size_t k) { found[k] = geom::distance_derivatives(a, X_WA[k], b, X_WB[k], at[k]); });
  const auto twice = std::count_if(found.begin(), found.end(), [](const auto& d) { return d.twice(); });
  std::printf("%-34s %9.0f %12.0f %8.2f   %ld of %zu\n", name.c_str(), distances, derivatives, derivatives / distances,
              static_cast<long>(twice), kPairs);
}

}  // namespace

int main() {
  const std::vector<std::pair<std::string, geom::Shape>> kinds = {
      {"sphere", geom::Sphere(1)},
      {"ellipsoid", geom::Ellipsoid({1, 1.5, 2})},
      {"superellipsoid", geom::Superellipsoid({1, 1.5, 2}, 0.7, 0.8)},
      {"capsule", geom::Capsule(1, 0.5)},
      {"box", geom::Box({1, 1.5, 2})},
      {"cylinder", geom::Cylinder(1, 0.7)},
      {"cone", geom::Cone(2, 0.7)},
      {"dodecahedron", geom::ConvexPolyhedron(geom::solid_vertices("dodecahedron"))},
      {"rounded box", geom::Rounded<geom::Box>(geom::Box({1, 1.5, 2}), 0.2)}};
  std::printf("%-34s %9s %12s %8s   %s\n", "pair, ns", "distance", "derivatives", "ratio", "all derivatives");
  for (const auto& [name, shape] : kinds) {
    print_row(name + ", " + name, shape, shape);
    if (name != "ellipsoid") print_row(name + ", ellipsoid", shape, geom::Ellipsoid({1, 1.5, 2}));
  }
}
