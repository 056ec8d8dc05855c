#pragma once

/// Base of the descents to the closest features of two cores: bounds, and the last simplex.

#include "cores/contact.h"
#include "cores/placed_core.h"

#include <geom/kernel/core_simplex.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>

namespace geom::kernel {

/// Bounds of cores' distances that differ by no more than this times the size are as good as equal.
inline constexpr double kCoreRounding = 5e-16;

/// Base of descents for two cores that are apart. `Core`: PlacedCore or RoundCore.
template <class Core>
class CoreDescent {
 public:
  /// Tries the normals of all edges and triangles of the last simplex: rounding may have made a wrong choice among
  /// them.
  void try_all_faces() {
    const SimplexFaces faces(last_);
    const auto across = [](const Eigen::Vector3d& x, const Eigen::Vector3d& e) {
      return Eigen::Vector3d(x - x.dot(e) / e.squaredNorm() * e);
    };
    const auto consider = [this](const Eigen::Vector3d& x) {
      const double length = x.norm();
      if (length > tolerance_) (void)evaluate(x / length);
    };
    for (std::size_t i = 0; i < last_.count; ++i) {
      for (std::size_t j = i + 1; j < last_.count; ++j) {
        const Eigen::Vector3d e = last_.vertex[j].p - last_.vertex[i].p;
        consider(across(across(last_.vertex[i].p, e), e));
        for (std::size_t k = j + 1; k < last_.count; ++k) {
          const Eigen::Vector3d n = e.cross(last_.vertex[k].p - last_.vertex[i].p);
          if (n.squaredNorm() > 0) consider(faces.foot_on_plane(i, j, k, n, n.squaredNorm()));
        }
      }
    }
  }

  /// Returns whether the bounds agree.
  bool closed() const { return std::sqrt(best_.squared) - contact_.lower <= tolerance_; }

  /// Returns the answer, with the closest points of the simplex.
  CoreContact contact() const {
    CoreContact result = contact_;
    for (std::size_t k = 0; k < best_.count; ++k) {
      result.a += best_.weight[k] * best_.vertex[k].a;
      result.b += best_.weight[k] * best_.vertex[k].b;
    }
    result.evaluations = evaluations_;
    return result;
  }

 protected:
  static constexpr int kMostSteps = 200;
  static constexpr int kPatience = 4;
  static constexpr double kSameSquare = 1 + 1e-14;

  CoreDescent(const Core& a, const Core& b, double size) : a_(a), b_(b), tolerance_(kCoreRounding * size) {}

  /// Returns the vertex of B - A that is nearest along n, whose gap is a lower bound.
  DifferenceVertex evaluate(const Eigen::Vector3d& n) {
    ++evaluations_;
    DifferenceVertex v = difference_vertex(a_, b_, n);
    const double gap = n.dot(v.p);
    if (gap > contact_.lower) {
      contact_.lower = gap;
      contact_.n = n;
    }
    return v;
  }

  /// Returns whether the bounds agree with the gap across n; if so, takes both as the answer's. n is that of the
  /// closest point of the simplex: another normal whose gap is the same to rounding may be off by the square root of
  /// that.
  bool closes(const Eigen::Vector3d& n, double gap) {
    if (!(std::sqrt(best_.squared) - gap <= tolerance_)) return false;
    contact_.lower = gap;
    contact_.n = n;
    return true;
  }

  const Core& a_;
  const Core& b_;
  double tolerance_;
  CoreSimplex best_;
  CoreSimplex last_;  ///< simplex before it was reduced
  CoreContact contact_;

 private:
  int evaluations_ = 0;
};

}  // namespace geom::kernel
