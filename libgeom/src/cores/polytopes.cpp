#include "cores/contact.h"
#include "cores/depth.h"
#include "cores/placed_core.h"
#include "cores/simplex.h"

namespace geom::kernel {
namespace {

using Eigen::Vector3d;

/// Bounds of polytopes' distances that differ by no more than this times the size are as good as equal.
constexpr double kCoreRounding = 5e-16;

/// The algorithm of Gilbert, Johnson and Keerthi for two polytopes that are apart: closest points of a growing simplex
/// of the difference B - A. The vertices are finitely many, so that it ends with the closest features; the gap between
/// the tangent planes across each normal is a lower bound, the closest point an upper one.
class PolytopeDescent {
 public:
  PolytopeDescent(const PlacedCore& a, const PlacedCore& b, double size)
      : a_(a), b_(b), tolerance_(kCoreRounding * size) {}

  /// Runs from a normal; returns false if the polytopes overlap, or are too close to tell.
  bool run(const Vector3d& start) {
    Vector3d n = start;
    CoreSimplex simplex;
    for (int step = 0; step < kMostSteps; ++step) {
      const DifferenceVertex v = evaluate(n);
      if (best_.squared < std::numeric_limits<double>::infinity() && closed()) return true;
      if (simplex.has(v)) break;
      simplex.vertex[simplex.count++] = v;
      last_ = simplex;
      reduce_to_closest(simplex);
      if (simplex.inside) return false;
      if (!(simplex.squared < best_.squared)) break;
      best_ = simplex;
      const double length = std::sqrt(simplex.squared);
      if (!(length > tolerance_)) return false;
      n = simplex.closest / length;
    }
    return true;
  }

  /// Tries the normals of all faces of the last simplex, where rounding has made a wrong choice among them.
  void improve() {
    for (std::size_t i = 0; i < last_.count; ++i) {
      for (std::size_t j = i + 1; j < last_.count; ++j) {
        const Vector3d e = last_.vertex[j].p - last_.vertex[i].p;
        const Vector3d x = best_.closest - best_.closest.dot(e) / e.squaredNorm() * e;
        if (x.norm() > 0) (void)evaluate(x / x.norm());
        for (std::size_t k = j + 1; k < last_.count; ++k) {
          const Vector3d c = e.cross(last_.vertex[k].p - last_.vertex[i].p);
          const double length = c.norm();
          if (length > 0) (void)evaluate((c.dot(last_.vertex[i].p) < 0 ? -1 : 1) / length * c);
        }
      }
    }
  }

  bool closed() const { return std::sqrt(best_.squared) - contact_.lower <= tolerance_; }
  double upper() const { return std::sqrt(best_.squared); }

  /// Returns the answer, with the closest points of the simplex.
  CoreContact contact() const {
    CoreContact result = contact_;
    result.upper = upper();
    for (std::size_t k = 0; k < best_.count; ++k) {
      result.a += best_.weight[k] * best_.vertex[k].a;
      result.b += best_.weight[k] * best_.vertex[k].b;
    }
    result.evaluations = evaluations_;
    return result;
  }

 private:
  static constexpr int kMostSteps = 200;

  DifferenceVertex evaluate(const Vector3d& n) {
    ++evaluations_;
    const DifferenceVertex v = difference_vertex(a_, b_, n);
    const double gap = n.dot(v.p);
    if (gap > contact_.lower) {
      contact_.lower = gap;
      contact_.n = n;
    }
    return v;
  }

  const PlacedCore& a_;
  const PlacedCore& b_;
  double tolerance_;
  CoreSimplex best_;
  CoreSimplex last_;
  CoreContact contact_;
  int evaluations_ = 0;
};

/// Returns the closest points of polytopes that are apart, by as many descents as the bounds need to meet.
bool apart(const PlacedCore& a, const PlacedCore& b, double size, const Vector3d& start, CoreContact& contact) {
  constexpr int kMostDescents = 3;
  PolytopeDescent descent(a, b, size);
  Vector3d n = start;
  bool found = false;
  for (int k = 0; k < kMostDescents; ++k) {
    found = descent.run(n);
    if (!found || descent.closed()) break;
    descent.improve();
    if (descent.closed()) break;
    n = descent.contact().n;
  }
  contact = descent.contact();
  return found;
}

/// Returns the contact of polytopes that overlap or nearly touch.
CoreContact overlapping(const PlacedCore& a, const PlacedCore& b, double size, int evaluations) {
  const WidestGap widest = widest_gap(a, b);
  // Moved apart along the normal, the bodies are closest where they leave each other.
  const double way = 0.5 * size - widest.gap;
  CoreContact contact;
  (void)apart(a, b.moved(way * widest.n), 2 * size, widest.n, contact);
  contact.b -= way * widest.n;
  contact.upper = std::max(widest.gap, contact.upper - way);
  contact.n = widest.n;
  contact.lower = widest.gap;
  contact.evaluations += widest.evaluations + evaluations;
  return contact;
}

}  // namespace

CoreContact polytope_contact(const CoreView& a, const Eigen::Matrix3d& R_WA, const CoreView& b,
                             const Eigen::Matrix3d& R_WB, const Vector3d& r, const Vector3d& start) {
  const PlacedCore placed_a(a, R_WA, Vector3d::Zero());
  const PlacedCore placed_b(b, R_WB, r);
  const double size = r.norm() + a.bounding_radius + b.bounding_radius;
  CoreContact contact;
  if (apart(placed_a, placed_b, size, start, contact) && contact.lower > 0) return contact;
  return overlapping(placed_a, placed_b, size, contact.evaluations);
}

}  // namespace geom::kernel
