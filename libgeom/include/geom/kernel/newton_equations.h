#pragma once

/// Equations (dist8) of the paper, in eight and in five unknowns, made dimensionless (newton_impl.h says how).

#include <geom/kernel/small_solve.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace geom::kernel {

/// Value, gradient and Hessian of f at one point, in world axes, dimensionless.
struct LocalSurface {
  double value;
  Eigen::Vector3d gradient;
  Eigen::Matrix3d hessian;
};

/// Equation of a body in world axes about its own centre, points divided by `length` and f by `unit` * `length`.
template <ImplicitSurface Shape>
struct WorldSurface {
  const Shape& shape;
  const Eigen::Matrix3d& R;
  double length;
  double unit = 1;  ///< |gradient of the shape's f| at the seed

  LocalSurface operator()(const Eigen::Vector3d& s) const {
    const Eigen::Vector3d x = length * (R.transpose() * s);
    return {static_cast<double>(shape.value(x)) / (unit * length), R * (Eigen::Vector3d(shape.gradient(x)) / unit),
            R * (Eigen::Matrix3d(shape.hessian(x)) * (length / unit)) * R.transpose()};
  }
};

/// Unknowns of eqs. (dist8).
struct NewtonState {
  Eigen::Vector3d s_a;  ///< xA relative to A's centre
  Eigen::Vector3d s_b;  ///< xB relative to B's centre
  double alpha;
  double beta;
};

/// Residual F and Jacobian of eqs. (dist8) in (sA, sB, alpha, beta).
struct EightEquations {
  static constexpr int kSize = 8;
  using Vector = SmallVector<kSize>;
  using Matrix = SmallMatrix<kSize>;

  static void eliminate(const LocalSurface& /*f*/, const Eigen::Vector3d& /*r*/, NewtonState& /*y*/) {}

  static Vector residual(const LocalSurface& f, const LocalSurface& g, const Eigen::Vector3d& r, const NewtonState& y) {
    Vector F;
    F << f.gradient + y.alpha * y.alpha * g.gradient, f.value, g.value, y.s_a + y.beta * f.gradient - y.s_b - r;
    return F;
  }

  static Matrix jacobian(const LocalSurface& f, const LocalSurface& g, const NewtonState& y) {
    Matrix J = Matrix::Zero();
    J.block<3, 3>(0, 0) = f.hessian;
    J.block<3, 3>(0, 3) = y.alpha * y.alpha * g.hessian;
    J.block<3, 1>(0, 6) = 2 * y.alpha * g.gradient;
    J.block<1, 3>(3, 0) = f.gradient.transpose();
    J.block<1, 3>(4, 3) = g.gradient.transpose();
    J.block<3, 3>(5, 0) = Eigen::Matrix3d::Identity() + y.beta * f.hessian;
    J.block<3, 3>(5, 3) = -Eigen::Matrix3d::Identity();
    J.block<3, 1>(5, 7) = f.gradient;
    return J;
  }

  static NewtonState moved(const NewtonState& y, const Vector& step) {
    return {y.s_a + step.head<3>(), y.s_b + step.segment<3>(3), y.alpha + step[6], y.beta + step[7]};
  }

  /// Returns the length of a step: the largest displacement of the points.
  static double length(const Vector& step) { return step.head<6>().cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }
};

/// Residual F and Jacobian in (sA, alpha, beta), with sB = sA + beta f_x - r, eq. (dist8d), inserted into the other
/// equations.
struct FiveEquations {
  static constexpr int kSize = 5;
  using Vector = SmallVector<kSize>;
  using Matrix = SmallMatrix<kSize>;

  static void eliminate(const LocalSurface& f, const Eigen::Vector3d& r, NewtonState& y) {
    y.s_b = y.s_a + y.beta * f.gradient - r;
  }

  static Vector residual(const LocalSurface& f, const LocalSurface& g, const Eigen::Vector3d& /*r*/,
                         const NewtonState& y) {
    Vector F;
    F << f.gradient + y.alpha * y.alpha * g.gradient, f.value, g.value;
    return F;
  }

  static Matrix jacobian(const LocalSurface& f, const LocalSurface& g, const NewtonState& y) {
    const Eigen::Matrix3d ds_b = Eigen::Matrix3d::Identity() + y.beta * f.hessian;  // d sB / d sA
    const Eigen::Matrix3d H_b = y.alpha * y.alpha * g.hessian;
    Matrix J = Matrix::Zero();
    J.block<3, 3>(0, 0) = f.hessian + H_b * ds_b;
    J.block<3, 1>(0, 3) = 2 * y.alpha * g.gradient;
    J.block<3, 1>(0, 4) = H_b * f.gradient;
    J.block<1, 3>(3, 0) = f.gradient.transpose();
    J.block<1, 3>(4, 0) = g.gradient.transpose() * ds_b;
    J(4, 4) = g.gradient.dot(f.gradient);
    return J;
  }

  static NewtonState moved(const NewtonState& y, const Vector& step) {
    return {y.s_a + step.head<3>(), y.s_b, y.alpha + step[3], y.beta + step[4]};
  }

  static double length(const Vector& step) {
    const double beta = std::abs(step[4]);
    const double points = step.head<3>().cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    // NaN if either is: std::max would return its first argument.
    return std::isnan(beta) ? beta : std::max(points, beta);
  }
};

/// Point of the iteration with all values evaluated there.
template <class Equations>
struct NewtonPoint {
  NewtonState y;
  LocalSurface f;
  LocalSurface g;
  typename Equations::Vector F;
};

template <class Equations, ImplicitSurface ShapeA, ImplicitSurface ShapeB>
NewtonPoint<Equations> newton_point(const WorldSurface<ShapeA>& a, const WorldSurface<ShapeB>& b,
                                    const Eigen::Vector3d& r, NewtonState y) {
  const LocalSurface f = a(y.s_a);
  Equations::eliminate(f, r, y);
  const LocalSurface g = b(y.s_b);
  return {y, f, g, Equations::residual(f, g, r, y)};
}

}  // namespace geom::kernel
