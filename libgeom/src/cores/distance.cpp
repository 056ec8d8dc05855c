#include "cores/contact.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Largest rounding of the square of a unit normal.
constexpr double kUnitNormal = 1e-12;

bool is_line(const CoreView& core) {
  return core.kind == CoreKind::point || core.kind == CoreKind::segment;
}

CoreContact contact_of(const CoreView& a, const Matrix3d& R_WA, const CoreView& b, const Matrix3d& R_WB,
                       const Vector3d& r, const Vector3d& start) {
  if (is_line(a) && is_line(b)) {
    return segment_contact(R_WA.col(2), a.half.z(), R_WB.col(2), b.half.z(), r);
  }
  if (a.kind == CoreKind::box && b.kind == CoreKind::point) return box_point_contact(R_WA, a.half, r);
  if (a.kind == CoreKind::point && b.kind == CoreKind::box) {
    return exchanged(box_point_contact(R_WB, b.half, -r), r);
  }
  if (a.kind == CoreKind::frustum || b.kind == CoreKind::frustum) {
    if (b.kind == CoreKind::point) return frustum_point_contact(a, R_WA, r);
    if (a.kind == CoreKind::point) return exchanged(frustum_point_contact(b, R_WB, -r), r);
    return round_contact(a, without_dust(R_WA), b, without_dust(R_WB), without_dust(r), without_dust(start));
  }
  return polytope_contact(a, without_dust(R_WA), b, without_dust(R_WB), without_dust(r), without_dust(start));
}

/// Returns the point of a core, without its ball, that is closest to x.
Vector3d closest_point(CoreView core, const Matrix3d& R, const Vector3d& centre, const Vector3d& x) {
  core.radius = 0;
  const CoreContact c = contact_of(core, R, {}, Matrix3d::Identity(), x - centre, unit_or_x(x - centre));
  return c.lower > 0 ? Vector3d(centre + c.a) : x;
}

/// Returns the point of a core, without its ball, that is furthest along n.
Vector3d furthest_point(const CoreView& core, const Matrix3d& R, const Vector3d& centre, const Vector3d& n) {
  return centre + R * core_support(core, R.transpose() * n).point;
}

/// Lets the points of overlapping cores that do not match approach each other, on the faces and edges that the normal
/// belongs to.
///
/// Moved apart along the normal by the depth, the bodies touch. Each point in turn becomes that of its body closest to
/// the other point; the two converge to a common one (alternating projections on convex sets). On round sides they
/// hardly move: then B's point furthest against the normal is the better start.
void project_points(const CoreView& a, const Matrix3d& R_WA, const CoreView& b, const Matrix3d& R_WB, const Vector3d& r,
                    double size, CoreContact& c) {
  constexpr int kMostSteps = 100;
  constexpr double kAgreement = 1e-15;
  constexpr double kSlow = 0.95;
  const Vector3d way = c.lower * c.n;
  for (const Vector3d& start : {c.b, furthest_point(b, R_WB, r, -c.n)}) {
    CoreContact next = c;
    next.b = start;
    double last = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMostSteps; ++step) {
      next.a = closest_point(a, R_WA, Vector3d::Zero(), next.b - way);
      next.b = closest_point(b, R_WB, r, next.a + way);
      const double mismatch = mismatch_of(next);
      if (mismatch < mismatch_of(c)) c = next;
      if (mismatch <= kAgreement * size) return;
      if (!(mismatch < kSlow * last)) break;
      last = mismatch;
    }
    if (mismatch_of(c) <= kBoundGap * size) return;
  }
}

}  // namespace

DistanceResult core_distance(const CoreView& a, const Pose& X_WA, const CoreView& b, const Pose& X_WB,
                             const DistanceOptions& options) {
  const Vector3d r = X_WB.position() - X_WA.position();
  const Vector3d start = is_warm(options.start) ? Vector3d(options.start / options.start.norm()) : unit_or_x(r);
  CoreContact c = contact_of(a, X_WA.rotation(), b, X_WB.rotation(), r, start);
  DistanceResult result;
  result.iterations = c.evaluations;
  const double size = r.norm() + a.bounding_radius + b.bounding_radius;
  double bound = bound_of(c);
  if (bound > kBoundGap * size && c.lower <= 0) [[unlikely]] {
    project_points(a, X_WA.rotation(), b, X_WB.rotation(), r, size, c);
    bound = bound_of(c);
  }
  // Where the depth is known by a search, the points that belong to it may be off by more.
  if (!(bound <= (c.depth_error > 0 ? kWidestGap : kBoundGap) * size) || !(c.depth_error <= kWidestDepthGap * size)) {
    return result;
  }
  if (!(std::abs(c.n.squaredNorm() - 1) <= kUnitNormal)) return result;
  result.distance = (c.lower - a.radius) - b.radius;
  result.normal = c.n;
  const Vector3d gap = c.b - c.a;
  const Vector3d y = gap - gap.dot(c.n) * c.n;
  result.point_a = X_WA.position() + (c.a + a.radius * c.n + 0.5 * y);
  result.point_b = result.point_a + result.distance * c.n;
  result.residual = c.depth_error > 0 ? bound : y.norm();
  result.error_bound = c.depth_error > 0 ? c.depth_error : bound;
  result.status = result.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return result;
}

bool core_contains(const CoreView& core, const Vector3d& x) {
  if (core.radius == 0 && core.kind == CoreKind::box) return (x.cwiseAbs().array() <= core.half.array()).all();
  if (core.radius == 0 && core.kind == CoreKind::hull) {
    const Hull& hull = *core.hull;
    for (std::size_t f = 0; f < hull.normals.size(); ++f) {
      if (!(hull.normals[f].dot(x) <= hull.offsets[f])) return false;
    }
    return true;
  }
  if (core.radius == 0 && core.kind == CoreKind::frustum) return frustum_contains(core, x);
  return core_distance({}, Pose::translation(x), core, Pose(), {}).distance <= 0;
}

}  // namespace geom::kernel
