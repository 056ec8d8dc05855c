#pragma once

#include <ed/export.h>

#include <Eigen/Core>

#include <cstdint>

namespace ed {

/// Pseudo-random numbers that do not depend on the machine's libm: xoshiro256** seeded by splitmix64 (Blackman and
/// Vigna), normal deviates by the ratio of uniforms (Leva, ACM TOMS 18 (1992) 449), which uses logarithms only in
/// comparisons, never in a result.
class ED_EXPORT Random {
 public:
  explicit Random(std::uint64_t seed);  ///< every seed is a good one

  std::uint64_t bits();         ///< 64 random bits
  double uniform();             ///< uniform deviate in [0, 1)
  double normal();              ///< normal deviate, mean 0, variance 1
  Eigen::Vector3d normal3();    ///< three normal deviates
  Eigen::Vector3d direction();  ///< random direction, uniform on the unit sphere
  Eigen::Matrix3d rotation();   ///< random rotation, uniform over all orientations

 private:
  std::uint64_t state_[4];
};

}  // namespace ed
