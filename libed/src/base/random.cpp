#include <ed/random.h>

#include <Eigen/Geometry>

#include <cmath>

namespace ed {

Random::Random(std::uint64_t seed) {
  for (std::uint64_t& word : state_) {
    seed += 0x9E3779B97F4A7C15u;
    std::uint64_t z = seed;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    word = z ^ (z >> 31);
  }
}

std::uint64_t Random::bits() {
  const auto rotate = [](std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); };
  const std::uint64_t result = rotate(state_[1] * 5, 7) * 9;
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = rotate(state_[3], 45);
  return result;
}

double Random::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1p-53;
}

double Random::normal() {
  // Leva's constants: two quadratic curves that enclose the region of acceptance closely; the logarithm decides in 1 %
  // of the draws, and only whether a point is accepted.
  while (true) {
    const double u = 1 - uniform();
    const double v = 1.7156 * (uniform() - 0.5);
    const double x = u - 0.449871;
    const double y = std::abs(v) + 0.386595;
    const double q = x * x + y * (0.19600 * y - 0.25472 * x);
    if (q < 0.27597) return v / u;
    if (q > 0.27846) continue;
    if (v * v <= -4 * u * u * std::log(u)) return v / u;
  }
}

Eigen::Vector3d Random::normal3() {
  const double x = normal();
  const double y = normal();
  const double z = normal();
  return {x, y, z};
}

Eigen::Vector3d Random::direction() {
  while (true) {
    const Eigen::Vector3d v = normal3();
    const double norm = v.norm();
    if (norm > 1e-6) return v / norm;
  }
}

Eigen::Matrix3d Random::rotation() {
  Eigen::Matrix3d R;
  R.col(2) = direction();
  Eigen::Vector3d x;
  do {
    const Eigen::Vector3d v = direction();
    x = v - v.dot(R.col(2)) * R.col(2);
  } while (x.squaredNorm() < 1e-4);
  R.col(0) = x.normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

}  // namespace ed
