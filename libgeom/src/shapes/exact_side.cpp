#include "shapes/exact_side.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace geom::kernel {
namespace {

using Eigen::Vector3d;

/// Sum of doubles without rounding: components of increasing magnitude that do not overlap (Shewchuk, Discrete Comput.
/// Geom. 18 (1997) 305, "grow expansion").
class ExactSum {
 public:
  void add(double x) {
    double carried = x;
    for (std::size_t k = 0; k < count_; ++k) {
      const double sum = carried + part_[k];
      const double from_part = sum - carried;
      part_[k] = (carried - (sum - from_part)) + (part_[k] - from_part);
      carried = sum;
    }
    part_[count_++] = carried;
  }

  /// Adds a b: a product of two doubles is a sum of two, by a fused multiply-add.
  void add_product(double a, double b) {
    const double ab = a * b;
    add(std::fma(a, b, -ab));
    add(ab);
  }

  /// Adds a b c.
  void add_product(double a, double b, double c) {
    const double ab = a * b;
    const double rest = std::fma(a, b, -ab);
    const double high = ab * c;
    const double low = rest * c;
    add(std::fma(rest, c, -low));
    add(low);
    add(std::fma(ab, c, -high));
    add(high);
  }

  /// Returns the sum, accurate to rounding.
  double value() const {
    double sum = 0;
    for (std::size_t k = 0; k < count_; ++k) sum += part_[k];
    return sum;
  }

  int sign() const {
    for (std::size_t k = count_; k-- > 0;) {
      if (part_[k] != 0) return part_[k] > 0 ? 1 : -1;
    }
    return 0;
  }

 private:
  static constexpr std::size_t kMost = 96;  // 24 products of three numbers, four doubles each
  std::array<double, kMost> part_;
  std::size_t count_ = 0;
};

void add_determinant(ExactSum& sum, double sign, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    sum.add_product(sign * a[i], b[j], c[k]);
    sum.add_product(-sign * a[i], b[k], c[j]);
  }
}

int side_of_sums(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  ExactSum sum;
  add_determinant(sum, 1, b, c, p);
  add_determinant(sum, -1, a, c, p);
  add_determinant(sum, 1, a, b, p);
  add_determinant(sum, -1, a, b, c);
  return sum.sign();
}

}  // namespace

int exact_side(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const Vector3d u = b - a;
  const Vector3d v = c - a;
  const Vector3d w = p - a;
  double determinant = 0;
  double permanent = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    determinant += w[i] * (u[j] * v[k] - u[k] * v[j]);
    permanent += std::abs(w[i]) * (std::abs(u[j] * v[k]) + std::abs(u[k] * v[j]));
  }
  // Differences, products and sums have at most ten roundings a term; Shewchuk's bound of the same sum is (7 + 56 e) e.
  constexpr double kRoundings = 16 * 0x1p-53;
  if (std::abs(determinant) > kRoundings * permanent) return determinant > 0 ? 1 : -1;
  return side_of_sums(a, b, c, p);
}

Vector3d accurate_normal(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  Vector3d normal;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    ExactSum sum;
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      sum.add_product(p[j], q[k]);
      sum.add_product(-p[k], q[j]);
    }
    normal[i] = sum.value();
  }
  return normal;
}

}  // namespace geom::kernel
