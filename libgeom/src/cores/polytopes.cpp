#include "cores/contact.h"
#include "cores/depth.h"
#include "cores/descent.h"
#include "cores/placed_core.h"

#include <geom/kernel/core_simplex.h>

namespace geom::kernel {
namespace {

using Eigen::Vector3d;

/// The algorithm of Gilbert, Johnson and Keerthi for two polytopes that are apart: closest points of a growing simplex
/// of the difference B - A. The vertices are finitely many, so that it ends with the closest features; the gap between
/// the tangent planes across each normal is a lower bound, the closest point an upper one.
class PolytopeDescent : public CoreDescent<PlacedCore> {
 public:
  PolytopeDescent(const PlacedCore& a, const PlacedCore& b, double size) : CoreDescent(a, b, size) {}

  /// Runs from a normal; returns false if the polytopes overlap, or are too close to tell.
  bool run(const Vector3d& start) {
    Vector3d n = start;
    CoreSimplex simplex;
    int idle = 0;
    for (int step = 0; step < kMostSteps && idle < kPatience; ++step) {
      const double lower = contact_.lower;
      const DifferenceVertex v = evaluate(n);
      if (step > 0 && closes(n, n.dot(v.p))) return true;
      if (simplex.has(v)) break;
      simplex.vertex[simplex.count++] = v;
      last_ = simplex;
      reduce_to_closest(simplex);
      if (simplex.inside) return false;
      // A better normal changes the length by the square of its change only: below rounding where the cores are much
      // nearer than they are large, while the gap across it still grows.
      if (!(simplex.squared <= kSameSquare * best_.squared)) break;
      idle = simplex.squared < best_.squared || contact_.lower > lower ? 0 : idle + 1;
      best_ = simplex;
      const double length = std::sqrt(simplex.squared);
      if (!(length > tolerance_)) return false;
      n = simplex.closest / length;
    }
    return true;
  }
};

double gap_across(const PlacedCore& a, const PlacedCore& b, const Vector3d& n) {
  return n.dot(difference_vertex(a, b, n).p);
}

/// Brings the bounds of a contact together where the bodies are so close that rounding has spoilt the normal, and finds
/// the closest points of bodies that overlap.
///
/// Moved apart along the normal by about their size, the bodies have the same closest features, and the direction of
/// their closest points is accurate to rounding: the normal of a face or across an edge, whatever error the normal had
/// along it. The points are moved back, and kept if they lower `bound`, that of the contact. This is the proximal point
/// method for the largest gap between tangent planes.
void refine(const PlacedCore& a, const PlacedCore& b, double size, double bound, CoreContact& contact) {
  constexpr int kMostMoves = 8;
  for (int k = 0; k < kMostMoves; ++k) {
    const Vector3d way = (0.5 * size - contact.lower) * contact.n;
    const PlacedCore moved = b.moved(way);
    PolytopeDescent descent(a, moved, 2 * size);
    if (!descent.run(contact.n)) break;
    if (!descent.closed()) descent.try_all_faces();
    const CoreContact far = descent.contact();
    const double lower = gap_across(a, b, far.n);
    contact.evaluations += far.evaluations + 1;
    bool improved = false;
    if (lower > contact.lower) {
      // The points may have to be found once more, along this normal.
      contact.n = far.n;
      contact.lower = lower;
      if (std::isfinite(bound)) bound = bound_of(contact);
      improved = true;
    }
    CoreContact next = contact;
    // Of normals whose gaps differ by rounding that of the closest points is right.
    if (lower > contact.lower - kCoreRounding * size) {
      next.n = far.n;
      next.lower = lower;
    }
    next.a = far.a;
    next.b = far.b - way;
    if (const double next_bound = bound_of(next); next_bound < bound) {
      contact = next;
      bound = next_bound;
      improved = true;
    }
    if (!improved || bound <= kCoreRounding * size) break;
  }
}

/// Returns the contact of polytopes that overlap or nearly touch.
CoreContact overlapping(const PlacedCore& a, const PlacedCore& b, double size, int evaluations) {
  const WidestGap widest = widest_gap(a, b);
  CoreContact contact;
  contact.n = widest.n;
  contact.lower = widest.gap;
  contact.evaluations = widest.evaluations + evaluations;
  refine(a, b, size, std::numeric_limits<double>::infinity(), contact);
  return contact;
}

}  // namespace

CoreContact polytope_contact(const CoreView& a, const Eigen::Matrix3d& R_WA, const CoreView& b,
                             const Eigen::Matrix3d& R_WB, const Vector3d& r, const Vector3d& start) {
  const PlacedCore placed_a(a, R_WA, Vector3d::Zero());
  const PlacedCore placed_b(b, R_WB, r);
  const double size = r.norm() + a.bounding_radius + b.bounding_radius;
  PolytopeDescent descent(placed_a, placed_b, size);
  const bool apart = descent.run(start);
  CoreContact contact = descent.contact();
  if (!apart || !(contact.lower > 0)) return overlapping(placed_a, placed_b, size, contact.evaluations);
  // The points may be further apart than the simplex says, where rounding has spoilt their weights.
  const double bound = bound_of(contact);
  if (!descent.closed() || bound > 4 * kCoreRounding * size) refine(placed_a, placed_b, size, bound, contact);
  return contact;
}

}  // namespace geom::kernel
