#include "shapes/swept_frustum.h"

#include <array>
#include <cmath>
#include <numbers>

namespace geom::kernel {
namespace {

using std::numbers::pi;

/// Integrals of the outline of a body of revolution, from below to above: those of s^2 dz, s^2 z dz, s^2 z^2 dz and s^4
/// dz, s the distance from the axis. Volume and moments are they times pi, pi, pi and pi / 4 (for x^2).
class Outline {
 public:
  /// Adds a part of the outline: at(t) is its point (s, z), and its dz/dt, for t in [from, to]. The rule of Gauss and
  /// Legendre with 8 nodes is exact for polynomials up to degree 15, and on arcs of an eighth of pi exact to rounding.
  template <class At>
  void add(double from, double to, const At& at) {
    constexpr std::array<double, 4> kNode{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                          0.9602898564975363};
    constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                            0.1012285362903763};
    const double middle = 0.5 * (from + to);
    const double half = 0.5 * (to - from);
    for (std::size_t k = 0; k < kNode.size(); ++k) {
      for (const double side : {-half, half}) {
        const auto [s, z, dz] = at(middle + side * kNode[k]);
        const double weight = half * kWeight[k] * dz;
        const double s2 = s * s;
        sums_[0] += weight * s2;
        sums_[1] += weight * s2 * z;
        sums_[2] += weight * s2 * z * z;
        sums_[3] += weight * s2 * s2;
      }
    }
  }

  void add_arc(const CoreDisc& rim, double radius, double from, double to) {
    constexpr int kParts = 8;
    for (int k = 0; k < kParts; ++k) {
      const double step = (to - from) / kParts;
      add(from + k * step, from + (k + 1) * step, [&](double t) {
        return std::array{rim.radius + radius * std::cos(t), rim.z + radius * std::sin(t), radius * std::cos(t)};
      });
    }
  }

  SweptMass mass() const {
    SweptMass m;
    m.volume = pi * sums_[0];
    m.first_moment.z() = pi * sums_[1];
    m.second_moment.diagonal() << 0.25 * pi * sums_[3], 0.25 * pi * sums_[3], pi * sums_[2];
    return m;
  }

 private:
  std::array<double, 4> sums_{};
};

}  // namespace

/// The outline consists of the arcs about both rims and the line between them; the faces have dz = 0.
SweptMass swept_frustum(const CoreView& core) {
  // No structured binding: clang 14 captures none.
  const auto& low = core.disc[0];
  const auto& high = core.disc[1];
  const double r = core.radius;
  const double height = high.z - low.z;
  const double tilt = std::atan2(low.radius - high.radius, height);
  Outline outline;
  if (r > 0) outline.add_arc(low, r, -0.5 * pi, tilt);
  outline.add(0, 1, [&](double t) {
    return std::array{low.radius + t * (high.radius - low.radius) + r * std::cos(tilt),
                      low.z + t * height + r * std::sin(tilt), height};
  });
  if (r > 0) outline.add_arc(high, r, tilt, 0.5 * pi);
  return outline.mass();
}

}  // namespace geom::kernel
