#include "observables/order/cubatic.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kIterations = 200;
constexpr double kConverged = 1e-13;  ///< change of the form in an iteration, which is at most 1

/// The symmetric tensor <sum over axes of u u u u>: its 15 different elements by the powers of x, y and z.
class FourthMoment {
 public:
  FourthMoment(const std::vector<Matrix3d>& rotations, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (int axis = 0; axis < 3; ++axis) add(rotations[i].col(axis));
    }
    for (double& element : elements_) element /= static_cast<double>(end - begin);
  }

  /// Returns T n n n; its product with n is the form.
  Vector3d cubed(const Vector3d& n) const {
    Vector3d result = Vector3d::Zero();
    std::size_t k = 0;
    for (int x = 0; x <= 4; ++x) {
      for (int y = 0; x + y <= 4; ++y, ++k) {
        const int z = 4 - x - y;
        const double weighted = kMultiplicity[k] / 4 * elements_[k];
        // A quarter of the derivatives of the term n_x^x n_y^y n_z^z.
        if (x > 0) result.x() += weighted * x * power(n.x(), x - 1) * power(n.y(), y) * power(n.z(), z);
        if (y > 0) result.y() += weighted * y * power(n.x(), x) * power(n.y(), y - 1) * power(n.z(), z);
        if (z > 0) result.z() += weighted * z * power(n.x(), x) * power(n.y(), y) * power(n.z(), z - 1);
      }
    }
    return result;
  }

 private:
  /// 4! / (x! y! z!), in the order of the loops.
  static constexpr std::array<double, 15> kMultiplicity = {1, 4, 6, 4, 1, 4, 12, 12, 4, 6, 12, 6, 4, 4, 1};

  static double power(double x, int exponent) {
    double result = 1;
    for (int k = 0; k < exponent; ++k) result *= x;
    return result;
  }

  void add(const Vector3d& u) {
    std::size_t k = 0;
    for (int x = 0; x <= 4; ++x) {
      for (int y = 0; x + y <= 4; ++y, ++k) {
        elements_[k] += power(u.x(), x) * power(u.y(), y) * power(u.z(), 4 - x - y);
      }
    }
  }

  std::array<double, 15> elements_{};
};

double maximum_from(const FourthMoment& moment, Vector3d n) {
  double best = 0;
  for (int k = 0; k < kIterations; ++k) {
    const Vector3d next = moment.cubed(n);
    const double form = next.dot(n);
    n = next.normalized();
    const bool converged = form - best < kConverged;
    best = std::max(best, form);
    if (converged) break;
  }
  return best;
}

}  // namespace

double cubatic_order(const std::vector<Matrix3d>& rotations, std::size_t begin, std::size_t end) {
  const FourthMoment moment(rotations, begin, end);
  double best = 0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const Vector3d n(x, y, z);
        // Of n and -n one is enough.
        if (9 * x + 3 * y + z > 0) best = std::max(best, maximum_from(moment, n.normalized()));
      }
    }
  }
  return 2.5 * best - 1.5;
}

}  // namespace ed::internal
