#include "observables/order/bragg.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

namespace ed::internal {

using Eigen::Vector3d;
using Eigen::Vector3i;

double least_bragg_peak(double number) {
  return std::max(kBraggPeak, kBraggChance / number);
}

std::vector<Vector3i> allowed_vectors(double box, double largest_q, double number) {
  const double vectors_of_most = std::min(kMostPerBody * number, kMostPhases / number);
  const double shortened = std::cbrt(vectors_of_most / (2 * std::numbers::pi / 3));
  const double radius = std::min(largest_q * box / (2 * std::numbers::pi), shortened);
  const int most = static_cast<int>(radius);
  std::vector<Vector3i> vectors;
  for (int x = 0; x <= most; ++x) {
    for (int y = -most; y <= most; ++y) {
      for (int z = -most; z <= most; ++z) {
        const Vector3i n(x, y, z);
        if (!n.isZero() && n == one_of_two(n) && n.cast<double>().squaredNorm() <= radius * radius) {
          vectors.push_back(n);
        }
      }
    }
  }
  return vectors;
}

std::vector<double> intensities(const std::vector<Vector3i>& vectors, double box,
                                const std::vector<Vector3d>& positions, BodyRange range) {
  std::vector<double> S = WaveVectors(box, vectors).structure_factor(positions, range);
  for (double& value : S) value /= range.size();
  return S;
}

std::vector<Vector3i> strongest(const std::vector<Vector3i>& vectors, const std::vector<double>& values,
                                std::size_t most) {
  std::vector<std::size_t> order(vectors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto number = static_cast<std::ptrdiff_t>(std::min(most, order.size()));
  // Equal values in the order of the vectors, so that the choice is one and the same everywhere.
  std::partial_sort(order.begin(), order.begin() + number, order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] > values[b] || (values[a] == values[b] && a < b);
  });
  std::vector<Vector3i> chosen;
  for (std::ptrdiff_t k = 0; k < number; ++k) chosen.push_back(vectors[order[static_cast<std::size_t>(k)]]);
  return chosen;
}

}  // namespace ed::internal
