/// contact_patch beside the distance that it starts from, of bodies that lie on each other.
///
/// usage: bench_contact_patch [--benchmark_filter=...]

#include <geom/contact_patch.h>
#include <geom/geom.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

namespace {

using Eigen::Vector3d;

constexpr int kPairs = 256;

/// Pairs of one kind that lie on each other, turned about the normal and tilted by a thousandth.
template <class Shape>
struct Pairs {
  Pairs(Shape given, double height, double tilt) : shape(std::move(given)) {
    std::mt19937_64 engine(1);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
    };
    for (int k = 0; k < kPairs; ++k) {
      const double turn = uniform(-3, 3), lean = uniform(-tilt, tilt);
      const geom::Pose X = geom::Pose::from_quaternion(std::cos(0.5 * turn), 0, 0, std::sin(0.5 * turn)) *
                           geom::Pose::from_quaternion(std::cos(0.5 * lean), std::sin(0.5 * lean), 0, 0);
      poses.emplace_back(X.rotation(), Vector3d(uniform(-0.5, 0.5), uniform(-0.5, 0.5), height));
    }
  }

  Shape shape;
  std::vector<geom::Pose> poses;
};

template <class Shape>
void patches(benchmark::State& state, const Pairs<Shape>& pairs, double tolerance) {
  std::vector<geom::DistanceResult> at;
  for (const geom::Pose& X : pairs.poses) at.push_back(geom::distance(pairs.shape, geom::Pose(), pairs.shape, X));
  std::size_t k = 0;
  double points = 0;
  for (auto _ : state) {
    const geom::ContactPatch patch = geom::contact_patch(pairs.shape, geom::Pose(), pairs.shape, pairs.poses[k], at[k],
                                                         {.within = 5e-3, .tolerance = tolerance});
    points += static_cast<double>(patch.points.size());
    k = (k + 1) % kPairs;
  }
  state.counters["points"] = points / static_cast<double>(state.iterations());
}

template <class Shape>
void distances(benchmark::State& state, const Pairs<Shape>& pairs) {
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(geom::distance(pairs.shape, geom::Pose(), pairs.shape, pairs.poses[k]));
    k = (k + 1) % kPairs;
  }
}

/// Measures the distance (tolerance 0), or patches of this tolerance.
template <class Shape>
void measure(benchmark::State& state, const Pairs<Shape>& pairs, double tolerance) {
  if (tolerance == 0) {
    distances(state, pairs);
  } else {
    patches(state, pairs, tolerance);
  }
}

void boxes(benchmark::State& state, double tolerance) {
  static const Pairs pairs(geom::Box({1, 1, 1}), 1.999, 1e-3);
  measure(state, pairs, tolerance);
}
void polyhedra(benchmark::State& state, double tolerance) {
  static const Pairs pairs(geom::ConvexPolyhedron(geom::solid_vertices("dodecahedron")), 1.588, 1e-3);
  measure(state, pairs, tolerance);
}
void cylinders(benchmark::State& state, double tolerance) {
  static const Pairs pairs(geom::Cylinder(1, 1), 1.999, 1e-3);
  measure(state, pairs, tolerance);
}
void superellipsoids_e_0_2(benchmark::State& state, double tolerance) {
  static const Pairs pairs(geom::Superellipsoid({1, 1, 1}, 0.2, 0.2), 1.999, 1e-3);
  measure(state, pairs, tolerance);
}
void superellipsoids_e_0_5(benchmark::State& state, double tolerance) {
  static const Pairs pairs(geom::Superellipsoid({1, 1, 1}, 0.5, 0.5), 1.999, 1e-3);
  measure(state, pairs, tolerance);
}
void ellipsoids(benchmark::State& state, double tolerance) {
  static const Pairs pairs(geom::Ellipsoid({1, 1, 0.5}), 0.9, 1e-3);
  measure(state, pairs, tolerance);
}

BENCHMARK_CAPTURE(boxes, distance, 0);
BENCHMARK_CAPTURE(boxes, patch, 0.01);
BENCHMARK_CAPTURE(boxes, patch_5_percent, 0.05);
BENCHMARK_CAPTURE(polyhedra, distance, 0);
BENCHMARK_CAPTURE(polyhedra, patch, 0.01);
BENCHMARK_CAPTURE(polyhedra, patch_5_percent, 0.05);
BENCHMARK_CAPTURE(cylinders, distance, 0);
BENCHMARK_CAPTURE(cylinders, patch, 0.01);
BENCHMARK_CAPTURE(cylinders, patch_5_percent, 0.05);
BENCHMARK_CAPTURE(superellipsoids_e_0_2, distance, 0);
BENCHMARK_CAPTURE(superellipsoids_e_0_2, patch, 0.01);
BENCHMARK_CAPTURE(superellipsoids_e_0_2, patch_5_percent, 0.05);
BENCHMARK_CAPTURE(superellipsoids_e_0_5, distance, 0);
BENCHMARK_CAPTURE(superellipsoids_e_0_5, patch, 0.01);
BENCHMARK_CAPTURE(superellipsoids_e_0_5, patch_5_percent, 0.05);
BENCHMARK_CAPTURE(ellipsoids, distance, 0);
BENCHMARK_CAPTURE(ellipsoids, patch, 0.01);
BENCHMARK_CAPTURE(ellipsoids, patch_5_percent, 0.05);

}  // namespace

BENCHMARK_MAIN();
