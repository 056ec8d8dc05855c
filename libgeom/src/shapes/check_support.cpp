#include <geom/check_support.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSampleTolerance = 1e-9;
constexpr double kHessianTolerance = 1e-3;

/// Returns unit vectors along the axes, the diagonals and a spiral.
std::vector<Vector3d> sample_directions() {
  constexpr int kSpread = 252;
  constexpr double kGoldenAngle = 2.39996322972865332;
  std::vector<Vector3d> all;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) all.push_back(Vector3d(x, y, z).normalized());
      }
    }
  }
  for (int k = 0; k < kSpread; ++k) {
    const double z = 1 - (2 * k + 1.0) / kSpread;
    const double across = std::sqrt(1 - z * z);
    all.emplace_back(across * std::cos(kGoldenAngle * k), across * std::sin(kGoldenAngle * k), z);
  }
  return all;
}

std::ostream& operator<<(std::ostream& text, const Vector3d& v) {
  return text << '(' << v.x() << ", " << v.y() << ", " << v.z() << ')';
}

template <class... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Search for a fault; every function returns a sentence about it, or nothing.
class FaultSearch {
 public:
  explicit FaultSearch(const SupportFunctions& shape)
      : shape_(shape), tolerance_(kSampleTolerance * shape.bounding_radius) {}

  std::string run() {
    if (std::string fault = of_radii(); !fault.empty()) return fault;
    for (const Vector3d& n : directions_) {
      supports_.push_back(shape_.support(n));
      if (std::string fault = of_support(n, supports_.back()); !fault.empty()) return fault;
    }
    if (std::string fault = of_convexity(); !fault.empty()) return fault;
    for (std::size_t k = 0; k < directions_.size(); ++k) {
      if (std::string fault = of_hessian(directions_[k], supports_[k]); !fault.empty()) return fault;
    }
    return {};
  }

 private:
  std::string of_radii() const {
    const double outer = shape_.bounding_radius;
    const double inner = shape_.inscribed_radius;
    if (!(outer > 0) || !std::isfinite(outer)) {
      return sentence("bounding_radius() is ", outer, "; accepted: a positive number");
    }
    if (!(inner > 0 && inner <= outer + tolerance_)) {
      return sentence("inscribed_radius() is ", inner, "; accepted: positive, at most bounding_radius(), ", outer);
    }
    const double curvature = shape_.min_curvature_radius;
    if (!(curvature >= 0 && curvature <= inner + tolerance_)) {
      return sentence("min_curvature_radius() is ", curvature, "; accepted: 0 to inscribed_radius(), ", inner);
    }
    return {};
  }

  std::string of_support(const Vector3d& n, const Support& s) const {
    if (!std::isfinite(s.height) || !s.point.allFinite()) {
      return sentence("support", n, " is not finite: height ", s.height, ", point ", s.point);
    }
    if (std::abs(n.dot(s.point) - s.height) > tolerance_) {
      return sentence("support", n, " has the height ", s.height, ", but its point ", s.point,
                      " is at n.s = ", n.dot(s.point));
    }
    for (const double length : {1e-3, 1e3}) {
      const Support other = shape_.support(length * n);
      if (std::abs(other.height - length * s.height) > length * tolerance_) {
        return sentence("support", n, " has the height ", s.height, ", but ", length, " times that vector has ",
                        other.height, "; accepted: the height grows as the length of n");
      }
    }
    if (s.height > shape_.bounding_radius + tolerance_ || s.point.norm() > shape_.bounding_radius + tolerance_) {
      return sentence("support", n, " reaches to ", std::max(s.height, s.point.norm()), ", beyond bounding_radius(), ",
                      shape_.bounding_radius);
    }
    if (s.height < shape_.inscribed_radius - tolerance_) {
      return sentence("support", n, " has the height ", s.height, ", below inscribed_radius(), ",
                      shape_.inscribed_radius);
    }
    return {};
  }

  std::string of_convexity() const {
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      for (std::size_t j = 0; j < directions_.size(); ++j) {
        const double height = directions_[i].dot(supports_[j].point);
        if (height <= supports_[i].height + tolerance_) continue;
        return sentence("the body is not convex, or a point is not its furthest one: the point of support",
                        directions_[j], " is at ", height, " along ", directions_[i], ", where support has the height ",
                        supports_[i].height);
      }
    }
    return {};
  }

  std::string of_hessian(const Vector3d& n, const Support& s) const {
    const double least = kHessianTolerance * shape_.bounding_radius;
    const Matrix3d H = shape_.hessian(n);
    if (!H.allFinite()) return sentence("support_hessian", n, " is not finite");
    if ((H - H.transpose()).norm() > least) return sentence("support_hessian", n, " is not symmetric");
    const double size = std::max(shape_.bounding_radius, H.norm());
    if ((H * n).norm() > kHessianTolerance * size) {
      return sentence("support_hessian", n, " times n is ", Vector3d(H * n), "; accepted: 0");
    }
    const Vector3d t = n.unitOrthogonal();
    for (const Vector3d& u : {t, Vector3d(n.cross(t))}) {
      if (std::string fault = of_second_derivative(n, s, u, H); !fault.empty()) return fault;
    }
    return {};
  }

  /// Compares H u with differences of s along u, where those to both sides agree.
  std::string of_second_derivative(const Vector3d& n, const Support& s, const Vector3d& u, const Matrix3d& H) const {
    constexpr double kStep = 1e-5;
    const Vector3d after = (shape_.support(n + kStep * u).point - s.point) / kStep;
    const Vector3d before = (s.point - shape_.support(n - kStep * u).point) / kStep;
    const Vector3d nearer = (shape_.support(n + kStep / 4 * u).point - s.point) / (kStep / 4);
    const double least = kHessianTolerance * std::max(shape_.bounding_radius, after.norm());
    // Kinks, and curvature that is unbounded or changes within the step, are left out.
    if ((after - before).norm() > least || (after - nearer).norm() > least) return {};
    const Vector3d computed = H * u;
    if ((computed - after).norm() > 2 * least) {
      return sentence("support_hessian", n, " times ", u, " is ", computed, ", but the support point moves by ", after);
    }
    if (u.dot(computed) < shape_.min_curvature_radius - least) {
      return sentence("the radius of curvature across ", n, " is ", u.dot(computed), ", below min_curvature_radius(), ",
                      shape_.min_curvature_radius);
    }
    return {};
  }

  const SupportFunctions& shape_;
  double tolerance_;
  std::vector<Vector3d> directions_ = sample_directions();
  std::vector<Support> supports_;
};

}  // namespace

std::string support_fault(const SupportFunctions& shape) {
  return FaultSearch(shape).run();
}

}  // namespace geom::kernel
