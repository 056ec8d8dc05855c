/// Time of distance_batch on bodies and pairs that another program wrote, for comparisons between languages:
/// bench/python_distances.py writes them and prints ratios.
///
/// usage: bench_pairs FILE REPEATS
///
/// The file has the numbers of bodies and pairs (int64), three semi-axes, positions, quaternions w x y z (double) and
/// pairs of indices (int64). One line is printed: the least time of a pair in ns, with poses of each pair side by side
/// (spans), by reference, and from the arrays of the file, poses included; and the sum of all distances.

#include <geom/geom.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

template <class T>
std::vector<T> read(std::ifstream& file, std::size_t count) {
  std::vector<T> values(count);
  file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
  if (!file) throw std::runtime_error("the file ends early");
  return values;
}

/// Returns the least time of a call, in ns for each of `count` things.
template <class Call>
double least_time(int repeats, std::size_t count, Call call) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < repeats; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    call();
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - begin;
    least = std::min(least, time.count() / static_cast<double>(count));
  }
  return least;
}

void run(const std::string& name, int repeats) {
  std::ifstream file(name, std::ios::binary);
  const auto numbers = read<std::int64_t>(file, 2);
  const auto bodies = static_cast<std::size_t>(numbers[0]), pairs = static_cast<std::size_t>(numbers[1]);
  const auto axes = read<double>(file, 3), positions = read<double>(file, 3 * bodies);
  const auto quaternions = read<double>(file, 4 * bodies);
  const auto indices = read<std::int64_t>(file, 2 * pairs);

  const geom::Ellipsoid shape({axes[0], axes[1], axes[2]});
  std::vector<geom::Pose> poses(bodies);
  const auto read_poses = [&] {
    for (std::size_t i = 0; i < bodies; ++i) {
      const double* const q = &quaternions[4 * i];
      poses[i] = geom::Pose::from_quaternion(q[0], q[1], q[2], q[3], Eigen::Vector3d::Map(&positions[3 * i]));
    }
  };
  read_poses();
  std::vector<geom::Pose> X_WA, X_WB;
  std::vector<geom::EllipsoidPair> references(pairs);
  const auto read_pairs = [&] {
    for (std::size_t k = 0; k < pairs; ++k) {
      const auto a = static_cast<std::size_t>(indices[2 * k]), b = static_cast<std::size_t>(indices[2 * k + 1]);
      references[k] = {&shape, &poses[a], &shape, &poses[b]};
    }
  };
  read_pairs();
  for (const geom::EllipsoidPair& pair : references) {
    X_WA.push_back(*pair.X_WA);
    X_WB.push_back(*pair.X_WB);
  }
  std::vector<geom::DistanceResult> results(pairs);
  const double of_spans = least_time(repeats, pairs, [&] {
    geom::distance_batch({&shape, 1}, X_WA, {&shape, 1}, X_WB, results);
  });
  const double of_references = least_time(repeats, pairs, [&] { geom::distance_batch(references, results); });
  const double of_arrays = least_time(repeats, pairs, [&] {
    read_poses();
    read_pairs();
    geom::distance_batch(references, results);
  });
  double sum = 0;
  for (const geom::DistanceResult& r : results) sum += r.distance;
  std::printf("%.3f %.3f %.3f %.17g\n", of_spans, of_references, of_arrays, sum);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bench_pairs FILE REPEATS\n");
    return 2;
  }
  try {
    run(argv[1], std::atoi(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_pairs: %s\n", error.what());
    return 2;
  }
}
