/// Scene::pairs_within of many mixed bodies, a quarter each of ellipsoids, superellipsoids, capsules and polyhedra,
/// beside FCL's dynamic tree of boxes with FCL's distances on the same bodies (where FCL is built in; superellipsoids
/// are hulls of 114 points there).
///
/// usage: bench_scene [BODIES...]        (10000 100000)
///
/// Bodies have random orientations, no two overlap, and there are 0.8 pairs within the cut-off a body. "Built":
/// scene, bodies and first query; "moved": all bodies by 1 % of their size, and a query.

#include <geom/geom.h>
#include <geom/scene.h>

#ifdef HARDBODY_WITH_SEEDS
#include "oracle/fcl_raw.h"
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

using Eigen::Vector3d;

constexpr double kCutoff = 0.5;
constexpr double kSpacing = 2.15;  ///< edge of the lattice; bounding radii are 1

class Random {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Vector3d vector(double reach) {
    const double x = uniform(-reach, reach), y = uniform(-reach, reach);
    return {x, y, uniform(-reach, reach)};
  }

 private:
  std::mt19937_64 engine_{1};
};

struct Bodies {
  std::vector<geom::Shape> shapes;
  std::vector<geom::Pose> poses;
};

std::vector<geom::Shape> kinds() {
  Random random;
  std::vector<Vector3d> points;
  for (int k = 0; k < 20; ++k) points.push_back(random.vector(1).normalized());
  return {geom::Ellipsoid({0.6, 0.8, 1}), geom::Superellipsoid({0.6, 0.6, 0.6}, 0.5, 0.5), geom::Capsule(0.5, 0.5),
          geom::ConvexPolyhedron(points)};
}

Bodies bodies(int count) {
  const std::vector<geom::Shape> all = kinds();
  Bodies made;
  Random random;
  const int edge = static_cast<int>(std::ceil(std::cbrt(count)));
  for (int k = 0; k < count; ++k) {
    const Vector3d place(k % edge, k / edge % edge, k / edge / edge);
    const Vector3d axis = random.vector(1);
    made.shapes.push_back(all[static_cast<std::size_t>(random.uniform(0, 4))]);
    made.poses.push_back(geom::Pose::normalized_quaternion(random.uniform(-1, 1), axis.x(), axis.y(), axis.z(),
                                                           kSpacing * place + random.vector(0.05)));
  }
  return made;
}

template <class F>
double seconds(const F& f) {
  const auto begin = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Returns the median of a few numbers.
double median(std::vector<double> numbers) {
  std::nth_element(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2), numbers.end());
  return numbers[numbers.size() / 2];
}

std::vector<geom::Pose> moved(const std::vector<geom::Pose>& poses, Random& random) {
  std::vector<geom::Pose> all;
  for (const geom::Pose& pose : poses) all.emplace_back(pose.rotation(), pose.position() + random.vector(0.01));
  return all;
}

void row(int count) {
  const Bodies start = bodies(count);
  std::vector<double> built, after_moves;
  std::size_t pairs = 0;
  for (int round = 0; round < 3; ++round) {
    Random random;
    geom::Scene scene({.margin = 0.05});
    std::vector<geom::ScenePair> found;
    std::vector<geom::BodyId> handles;
    built.push_back(seconds([&] {
      for (std::size_t k = 0; k < start.shapes.size(); ++k)
        handles.push_back(scene.add(start.shapes[k], start.poses[k]));
      scene.pairs_within(kCutoff, found);
    }));
    pairs = found.size();
    const std::vector<geom::Pose> next = moved(start.poses, random);
    after_moves.push_back(seconds([&] {
      scene.move(handles, next);
      scene.pairs_within(kCutoff, found);
    }));
    double candidates = 0;
    const double broad = seconds([&] {
      scene.candidates(kCutoff, [&](geom::BodyId, geom::BodyId, const Vector3d&) { return ++candidates > 0; });
    });
    if (round == 0) std::printf("| %d | %zu | %.0f | %.1f |", count, pairs, candidates, 1e3 * broad);
  }
  std::printf(" %.1f | %.1f |", 1e3 * median(built), 1e3 * median(after_moves));
#ifdef HARDBODY_WITH_SEEDS
  std::vector<double> theirs_built, theirs_moved;
  std::size_t theirs = 0;
  for (int round = 0; round < 3; ++round) {
    Random random;
    geom_test::FclScene scene;
    for (std::size_t k = 0; k < start.shapes.size(); ++k) scene.add(start.shapes[k], start.poses[k]);
    theirs_built.push_back(seconds([&] {
      scene.build();
      theirs = scene.pairs_within(kCutoff).size();
    }));
    const std::vector<geom::Pose> next = moved(start.poses, random);
    theirs_moved.push_back(seconds([&] {
      scene.move(next);
      (void)scene.pairs_within(kCutoff);
    }));
  }
  std::printf(" %zu | %.1f | %.1f | %.1f | %.1f |", theirs, 1e3 * median(theirs_built), 1e3 * median(theirs_moved),
              median(theirs_built) / median(built), median(theirs_moved) / median(after_moves));
#endif
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("| bodies | pairs | candidates | their search, ms | built, ms | moved, ms |");
#ifdef HARDBODY_WITH_SEEDS
  std::printf(" FCL: pairs | built, ms | moved, ms | its time / ours, built | moved |");
#endif
  std::printf("\n");
  if (argc < 2) {
    for (const int count : {10000, 100000}) row(count);
  }
  for (int k = 1; k < argc; ++k) row(std::atoi(argv[k]));
}
