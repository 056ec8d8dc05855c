#include "cores/contact.h"
#include "cores/descent.h"
#include "cores/rims.h"
#include "cores/shallow.h"

#include <geom/distance.h>
#include <geom/kernel/core_simplex.h>
#include <geom/kernel/distance_impl.h>
#include <geom/tolerances.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The algorithm of Gilbert, Johnson and Keerthi for two cores that are apart, with vertices that slide along their
/// rims (rims.h): a simplex is the hull of up to three discs, of which there are finitely many.
class RoundDescent : public CoreDescent<RoundCore> {
 public:
  RoundDescent(const RoundCore& a, const RoundCore& b, double size) : CoreDescent(a, b, size), size_(size) {}

  /// Runs from a normal; returns false if the cores overlap, or are too close to tell.
  bool run(const Vector3d& start) {
    Vector3d n = start;
    CoreSimplex simplex;
    int idle = 0;
    for (int step = 0; step < kMostSteps && idle < kPatience; ++step) {
      const double lower = contact_.lower;
      const DifferenceVertex v = evaluate(n);
      if (step > 0 && closes(n, n.dot(v.p))) return true;
      if (rival_ && closed()) return true;
      if (known(simplex, v)) break;
      simplex.vertex[simplex.count++] = v;
      last_ = simplex;
      reduce_to_closest(simplex);
      if (simplex.inside) return false;
      // Rounding of the points, not of their distance, decides where the bodies nearly touch: sliding tells more.
      const bool longer = !(simplex.squared <= kSameSquare * best_.squared);
      const double length = std::sqrt(simplex.squared);
      if (longer && !(length <= std::sqrt(best_.squared) + kUnresolved * size_)) break;
      if (!longer) {
        idle = simplex.squared < best_.squared || contact_.lower > lower ? 0 : idle + 1;
        best_ = simplex;
      }
      if (!(length > tolerance_)) return false;
      const Vector3d closest = simplex.closest / length;
      // The normal that the vertices belong to is right where the bodies nearly touch, the other one far away.
      if (take_slid(simplex, closest, n)) continue;
      n = closest;
      if (!take_slid(simplex, closest, n) && longer) break;
    }
    return true;
  }

  const CoreSimplex& simplex() const { return best_; }

 private:
  static constexpr double kUnresolved = 1e-12;

  /// Returns whether a vertex is in the simplex, to rounding.
  bool known(const CoreSimplex& simplex, const DifferenceVertex& v) const {
    for (std::size_t k = 0; k < simplex.count; ++k) {
      const DifferenceVertex& w = simplex.vertex[k];
      if (w.id_a == v.id_a && w.id_b == v.id_b && (w.p - v.p).squaredNorm() <= tolerance_ * tolerance_) return true;
    }
    return false;
  }

  /// Lets the vertices slide, from the normal n, if that shortens the closest point.
  bool take_slid(CoreSimplex& simplex, const Vector3d& closest, Vector3d& n) {
    if (!(n.dot(closest) > 0)) return false;
    CoreSimplex slid = simplex;
    Vector3d m = n;
    Vector3d rival = Vector3d::Zero();
    const bool slides = slide(a_, b_, size_, slid, m, rival);
    rival_ = !rival.isZero(0);
    if (rival_) (void)evaluate(rival);
    if (!slides || !(slid.squared <= kSameSquare * best_.squared)) return false;
    if (!(m.dot(slid.closest) > 0)) return false;
    simplex = best_ = slid;
    n = m;
    return true;
  }

  double size_;
  bool rival_ = false;  // whether the last slide left out a vertex that may belong to the answer
};

/// Mismatch, in units of the size, that is rounding.
constexpr double kAgreement = 4e-15;

/// Returns whether the bodies are apart or touch to rounding: the distance is between the gap and that of the points.
bool apart_or_touching(const CoreContact& c, double size) {
  return c.lower > -2 * kCoreRounding * size;
}

/// Returns the contact where the vertices of bodies that were moved apart by `way` slide to when they are moved back;
/// `far` if that is not found. Newton's method converges to curved features of bodies that overlap, too.
CoreContact slid_back(const RoundCore& a, const RoundCore& b, double size, CoreSimplex simplex, const Vector3d& way,
                      const CoreContact& far) {
  for (std::size_t k = 0; k < simplex.count; ++k) {
    simplex.vertex[k].b -= way;
    simplex.vertex[k].p -= way;
  }
  CoreContact contact;
  contact.n = far.n;
  Vector3d rival;
  if (!slide(a, b, size, simplex, contact.n, rival)) return far;
  for (std::size_t k = 0; k < simplex.count; ++k) {
    contact.a += simplex.weight[k] * simplex.vertex[k].a;
    contact.b += simplex.weight[k] * simplex.vertex[k].b;
  }
  contact.lower = contact.n.dot(difference_vertex(a, b, contact.n).p);
  return contact;
}

/// Improves a contact of points that do not match by `bound`, where rounding has spoilt the normal or decided that a
/// flat simplex is around the origin; finds the closest points of bodies that overlap.
///
/// Moved apart along the normal by about their size, the bodies have the same closest features, and the direction of
/// their closest points is accurate to rounding (the proximal point method for the largest gap between tangent planes).
/// Of curved features the normals converge slowly, but lead to one from where a descent finds the answer.
void improve(const RoundCore& a, const RoundCore& b, double size, double bound, CoreContact& contact) {
  constexpr int kMostMoves = 24;
  constexpr double kSlow = 0.7;   // share of the mismatch that is left by a move: then the next ones are shorter
  constexpr double kLoss = 1e-5;  // of the mismatch that is gained, in the gap
  constexpr double kFirstLoss = 8 * kCoreRounding;  // for points at all
  constexpr double kNear = 1e-8;                    // least distance, in units of the size
  Vector3d n = contact.n;
  double lower = contact.lower;
  double distance = 0.5 * size;
  double last = std::numeric_limits<double>::infinity();
  const auto take = [&](CoreContact next) {
    const double mismatch = mismatch_of(next);
    contact.evaluations += next.evaluations;
    // Points that match much better are worth a little of the gap.
    const double loss =
        std::max(kCoreRounding * size, std::isfinite(bound) ? kLoss * (bound - mismatch) : kFirstLoss * size);
    if (next.lower < contact.lower - loss) return false;
    if (!(mismatch < bound) && !(next.lower > contact.lower + kCoreRounding * size)) return false;
    next.evaluations = contact.evaluations;
    contact = next;
    bound = mismatch;
    return true;
  };
  for (int move = 0; move < kMostMoves; ++move) {
    const Vector3d way = (distance - lower) * n;
    const RoundCore moved = b.moved(way);
    RoundDescent descent(a, moved, 2 * size);
    if (!descent.run(n)) return;
    if (!descent.closed()) descent.try_all_faces();
    CoreContact far = descent.contact();
    far.b -= way;
    far.lower = far.n.dot(difference_vertex(a, b, far.n).p);
    const double missing = mismatch_of(far);
    const bool slow = missing > kSlow * last && missing > kAgreement * size;
    if (slow) distance = std::min(distance, std::max({0.1 * distance, 10 * -lower, kNear * size}));
    last = missing;
    const bool turned = (far.n - n).squaredNorm() > kCoreRounding * kCoreRounding;
    if (far.lower >= lower - kCoreRounding * size) {
      n = far.n;
      lower = far.lower;
    }
    bool better = take(far);
    better = take(slid_back(a, b, size, descent.simplex(), way, far)) || better;
    const bool best = apart_or_touching(contact, size) || !(lower > contact.lower + kCoreRounding * size);
    if (best && bound <= kAgreement * size) return;
    if (lower > 0) {
      RoundDescent again(a, b, size);
      if (again.run(n) && again.contact().lower > 0) (void)take(again.contact());
      if (bound <= kAgreement * size) return;
    }
    if (!better && !turned && !slow) return;
  }
}

/// Finds a contact of a face of A, a frustum, with B above it: the normal is the axis, and the points are below those
/// of B that are furthest down. Returns false if there is none, or B's point is beyond the face.
bool face_contact(const RoundCore& a, const RoundCore& b, double size, CoreContact& contact) {
  if (!a.round()) return false;
  const bool up = a.axis().dot(b.origin() - a.origin()) > 0;
  const Vector3d n = up ? a.axis() : Vector3d(-a.axis());
  const Vector3d middle = a.middle(up ? 1 : 0);
  const double radius = a.radius(up ? 1 : 0);
  if (!(radius > 0)) return false;
  const CoreVertex v = b.vertex(-n);
  const double gap = n.dot(v.x - middle);
  if (!(gap > kCoreRounding * size)) return false;
  Vector3d point = v.x;
  if (b.round()) {
    // Faces that are parallel, and a side parallel to the face.
    constexpr double kFlat = 1e-15;
    const Vector3d e = b.across(-n);
    const Vector3d other = b.middle(1 - v.id) + b.radius(1 - v.id) * e;
    if (n.cross(b.axis()).norm() <= kFlat) {
      const double reach = radius + b.radius(v.id);
      point = middle + radius / reach * (b.middle(v.id) - middle) + b.radius(v.id) / reach * n * gap;
    } else if (n.dot(other - v.x) <= kFlat * size) {
      const Vector3d way = other - v.x;
      point += std::clamp((middle - v.x).dot(way) / way.squaredNorm(), 0.0, 1.0) * way;
    }
  }
  const Vector3d from = point - middle;
  const Vector3d across = from - from.dot(n) * n;
  if (!(across.norm() <= (1 + 2 * kCoreRounding) * radius)) return false;
  contact.n = n;
  contact.lower = gap;
  contact.a = middle + across;
  contact.b = point + (gap - n.dot(point - contact.a)) * n;
  return true;
}

/// Returns the contact of cores that overlap or nearly touch, by a search of all normals. `near`: a contact that may be
/// the answer, as it mostly is of shallow overlaps; the search then only bounds the gaps of other normals.
CoreContact overlapping(const CoreView& core_a, const RoundCore& a, const Matrix3d& R_WA, const CoreView& core_b,
                        const RoundCore& b, const Matrix3d& R_WB, double size, const CoreContact& near) {
  const bool matches = near.lower < 0 && mismatch_of(near) <= kBoundGap * size;
  const double certain = matches ? certain_depth(a, b, size, near) : 0;
  // Without a proof of an overlap the bodies are no further apart than the points are.
  const double most_near = certain > 0 ? -certain : (near.b - near.a).norm();
  // The proof is as tight as the search would be.
  if (matches && most_near - near.lower <= kDepthGap * size) {
    CoreContact contact = near;
    contact.depth_error = std::max(most_near - near.lower, kCoreRounding * size);
    return contact;
  }
  const CoreBody body_a = CoreBody(core_a, 0).bare();
  const CoreBody body_b = CoreBody(core_b, 0).bare();
  const Vector3d r = b.origin() - a.origin();
  const GeneralPair pair(WorldSupport<CoreBody>{body_a, R_WA}, WorldSupport<CoreBody>{body_b, R_WB}, r,
                         kLeastEigenvalue * kLeastCurvature * size);
  const DistanceResult found = search_sphere(pair, {size, 0}, unit_or_x(r), Vector3d::Zero(), near.evaluations,
                                             common_axis(body_a, R_WA, body_b, R_WB));
  CoreContact contact;
  contact.evaluations = found.iterations;
  if (found.status == DistanceStatus::not_converged) return contact;
  contact.n = found.normal;
  contact.lower = found.normal.dot(difference_vertex(a, b, found.normal).p);
  double most = found.distance + found.error_bound;
  if (mismatch_of(near) <= kAgreement * size && near.lower >= contact.lower - kCoreRounding * size) {
    contact = near;
    if (matches) most = std::min(most, most_near);
    contact.evaluations = found.iterations;
  } else {
    improve(a, b, size, std::numeric_limits<double>::infinity(), contact);
  }
  if (apart_or_touching(contact, size) && bound_of(contact) <= kBoundGap * size) return contact;
  contact.depth_error = std::max(most - contact.lower, kCoreRounding * size);
  return contact;
}

}  // namespace

/// The frustum is an area in the half-plane of the axis and the point, whose coordinates are s and z.
CoreContact frustum_point_contact(const CoreView& frustum, const Matrix3d& R, const Vector3d& r) {
  const Vector3d p = R.transpose() * r;
  const double s = std::hypot(p.x(), p.y());
  const double z = p.z();
  const auto& [low, high] = frustum.disc;
  const double height = high.z - low.z;
  const double taper = low.radius - high.radius;
  const double slant = std::hypot(height, taper);
  const double above_side = (height * (s - low.radius) + taper * (z - low.z)) / slant;
  const double along_side = (height * (z - low.z) - taper * (s - low.radius)) / slant;
  // Normal (ns, nz) and the distance along it.
  double ns = 0;
  double nz = 1;
  double distance = 0;
  const auto from_rim = [&](const CoreDisc& rim) {
    distance = std::hypot(s - rim.radius, z - rim.z);
    ns = distance > 0 ? (s - rim.radius) / distance : height / slant;
    nz = distance > 0 ? (z - rim.z) / distance : taper / slant;
  };
  const auto from_side = [&] {
    distance = above_side;
    ns = height / slant;
    nz = taper / slant;
  };
  if (z <= low.z && s <= low.radius) {
    distance = low.z - z;
    nz = -1;
  } else if (z >= high.z && s <= high.radius) {
    distance = z - high.z;
  } else if ((above_side >= 0 || z < low.z) && along_side <= 0) {
    from_rim(low);
  } else if (above_side >= 0 && along_side >= slant) {
    from_rim(high);
  } else if (above_side >= 0) {
    from_side();
  } else {
    from_side();
    if (low.z - z > distance) {
      distance = low.z - z;
      ns = 0;
      nz = -1;
    }
    if (high.radius > 0 && z - high.z > distance) {
      distance = z - high.z;
      ns = 0;
      nz = 1;
    }
  }
  const Vector3d e = s > 0 ? Vector3d(p.x() / s, p.y() / s, 0) : Vector3d::UnitX();
  CoreContact contact;
  contact.n = R * (ns * e + nz * Vector3d::UnitZ());
  contact.lower = distance;
  contact.b = r;
  contact.a = r - distance * contact.n;
  return contact;
}

CoreContact round_contact(const CoreView& a, const Matrix3d& R_WA, const CoreView& b, const Matrix3d& R_WB,
                          const Vector3d& r, const Vector3d& start) {
  const RoundCore placed_a(a, R_WA, Vector3d::Zero());
  const RoundCore placed_b(b, R_WB, r);
  const double size = r.norm() + a.bounding_radius + b.bounding_radius;
  CoreContact face;
  if (face_contact(placed_a, placed_b, size, face)) return face;
  if (face_contact(placed_b, placed_a, size, face)) {
    std::swap(face.a, face.b);
    face.n = -face.n;
    return face;
  }
  RoundDescent descent(placed_a, placed_b, size);
  const bool apart = descent.run(start);
  CoreContact contact = descent.contact();
  const double bound = apart && contact.lower > 0 ? mismatch_of(contact) : std::numeric_limits<double>::infinity();
  if (!descent.closed() || !(bound <= kAgreement * size)) improve(placed_a, placed_b, size, bound, contact);
  if (!apart_or_touching(contact, size) || !(bound_of(contact) <= kBoundGap * size)) {
    contact = overlapping(a, placed_a, R_WA, b, placed_b, R_WB, size, contact);
  }
  settle_points(placed_a, placed_b, size, contact);
  return contact;
}

}  // namespace geom::kernel
