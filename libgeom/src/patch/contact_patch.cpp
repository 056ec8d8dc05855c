#include <geom/contact_patch.h>

#include "patch/outline.h"
#include "patch/polygon.h"
#include "patch/surface.h"

#include "shapes/format.h"

#include <geom/kernel/refuse.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <utility>

namespace geom {
namespace patch {
namespace {

/// Rounding of places, of the size of the pair.
constexpr double kPlaceRounding = 1e-14;
/// Widths and lengths, of the extent of the shadows' common part, below which polygons are segments and segments
/// points.
constexpr double kNarrowExact = 1e-9, kShortSmooth = 1e-6;
/// Largest width, of the length, of segments of curved surfaces.
constexpr double kMostNarrow = 0.1;
/// Distance, of that extent, up to which corners count as one, and are moved off the walls of polytopes.
constexpr double kSameCorner = 1e-6;
/// Share of the patch's width up to which they are moved.
constexpr double kShareMoved = 0.1;
/// Distance, of the size, of witness points from a line along the normal up to which the answer's points are used.
constexpr double kOnNormal = 1e-9;
constexpr int kSectors = 32;

/// Returns the place on the line from x along a unit vector, up to `reach` to both sides, where the gap is least; x if
/// rays find no surface. Parts of the line may be beyond the end of a shadow: gaps are those on the way to `inner`.
Vector2d least_gap(const Outline& outline, const Vector2d& x, const Vector2d& inner, const Vector2d& along,
                   double reach) {
  constexpr double kGolden = 0.6180339887498949;
  if (!outline.heights(x, inner)) return x;
  const auto gap = [&](double t) {
    const auto heights = outline.heights(x + t * along, inner);
    return heights ? heights->gap() : std::numeric_limits<double>::infinity();
  };
  double low = -reach, high = reach;
  double s = high - kGolden * (high - low), t = low + kGolden * (high - low);
  double gap_s = gap(s), gap_t = gap(t);
  for (int step = 0; step < 40; ++step) {
    if (gap_s < gap_t) {
      high = t;
      t = s;
      gap_t = gap_s;
      gap_s = gap(s = high - kGolden * (high - low));
    } else {
      low = s;
      s = t;
      gap_s = gap_t;
      gap_t = gap(t = low + kGolden * (high - low));
    }
  }
  return x + 0.5 * (low + high) * along;
}

/// Result under construction.
class Maker {
 public:
  /// `rounding`: distance (length) that is rounding.
  Maker(const Outline& outline, const Frame& frame, const Pose& reference, const PatchOptions& options, double rounding,
        ContactPatch& patch)
      : outline_(outline), frame_(frame), options_(options), rounding_(rounding), patch_(patch) {
    // The direction from which sectors are counted: an axis of the body that is not along the normal.
    const Eigen::Matrix3d axes = frame.axes.transpose() * reference.rotation();
    start_ = (std::abs(axes(2, 0)) < 0.8 ? axes.col(0) : axes.col(1)).head<2>();
  }

  void make(Polygon polygon) {
    const auto [i, j] = longest(polygon);
    const Vector2d way = polygon[j].place - polygon[i].place;
    const double length = way.norm();
    middle_ = centroid(polygon);
    patch_.error = outline_.error();
    const double across = length > 0 ? width_across(polygon, way / length) : 0;
    const double narrow = std::max(kNarrowExact * outline_.extent(), 10 * rounding_);
    if (length <= (outline_.is_exact() ? narrow : std::max(kShortSmooth * outline_.extent(), narrow))) {
      patch_.kind = PatchKind::point;
      add(middle_, 0);
    } else if (across <= (outline_.is_exact()
                              ? narrow
                              : std::max(std::min(3 * options_.tolerance, kMostNarrow) * length, narrow))) {
      patch_.kind = PatchKind::segment;
      reach_ = std::min(kSameCorner * outline_.extent(), kShareMoved * length);
      add_ends(polygon, i, j, way / length);
    } else {
      patch_.kind = PatchKind::polygon;
      reach_ = std::min(kSameCorner * outline_.extent(), kShareMoved * across);
      patch_.area = area(polygon);
      // A tilted side of a body leaves sides as short as the tilt beside its edges, which come and go.
      Polygon merged = polygon;
      if (merge(merged, kSameCorner * outline_.extent()) >= 3) polygon = std::move(merged);
      if (outline_.is_exact()) outline_.join_sides(polygon, reach_);
      reduce(polygon, static_cast<std::size_t>(options_.max_points));
      for (std::size_t k = 0; k < polygon.size(); ++k) add(polygon[k].place, identity(polygon, k));
    }
    const std::size_t least = patch_.kind == PatchKind::polygon ? 3 : patch_.kind == PatchKind::segment ? 2 : 1;
    if (patch_.points.size() < least) {
      // Rays did not find the surfaces.
      const Eigen::Vector3d normal = patch_.normal;
      patch_ = {};
      patch_.normal = normal;
      return;
    }
    if (const auto heights = outline_.heights(middle_, middle_)) {
      patch_.centre = frame_.to_world({middle_.x(), middle_.y(), 0.5 * (heights->a - heights->b)});
    }
  }

 private:
  void add_ends(const Polygon& polygon, std::size_t i, std::size_t j, const Vector2d& along) {
    const Vector2d across(-along.y(), along.x());
    const double reach = outline_.is_exact() ? 0 : width_across(polygon, along);
    for (const std::size_t k : {i, j}) {
      const Vector2d place = polygon[k].place;
      add(reach == 0 ? place : least_gap(outline_, place, middle_, across, reach), identity(polygon, k));
    }
    middle_ = 0.5 * (polygon[i].place + polygon[j].place);
    if (reach != 0) middle_ = least_gap(outline_, middle_, middle_, across, reach);
  }

  std::uint64_t identity(const Polygon& polygon, std::size_t k) const {
    if (outline_.is_exact()) {
      // A mixture of both sides: multiples of an odd number, with the upper half of the bits in the lower one.
      const std::uint64_t before = polygon[(k + polygon.size() - 1) % polygon.size()].side * 0xbf58476d1ce4e5b9;
      return (before ^ before >> 32) + polygon[k].side;
    }
    const Vector2d way = polygon[k].place - middle_;
    const double turn =
        std::atan2(start_.x() * way.y() - start_.y() * way.x(), start_.dot(way)) / (2 * std::numbers::pi);
    // Axes and diagonals are in the middle of sectors.
    const double sector = std::floor(kSectors * (turn + 1) + 0.5);
    return static_cast<std::uint64_t>(sector) % kSectors;
  }

  void add(const Vector2d& place, std::uint64_t id) {
    const auto heights =
        outline_.is_exact() ? outline_.heights_off_walls(place, reach_) : outline_.heights(place, middle_);
    if (!heights) return;
    // Corners in one sector: multiples of an odd number are different up to 2^64 of them.
    while (!known_.insert(id).second) id += 0x9e3779b97f4a7c15;
    const Vector2d& x = heights->place;
    patch_.points.push_back({frame_.to_world({x.x(), x.y(), heights->a}), frame_.to_world({x.x(), x.y(), -heights->b}),
                             -heights->gap(), id});
  }

  const Outline& outline_;
  const Frame& frame_;
  const PatchOptions& options_;
  double rounding_;
  ContactPatch& patch_;
  Vector2d start_, middle_ = Vector2d::Zero();
  double reach_ = 0;  ///< distance up to which corners are moved off walls
  std::set<std::uint64_t> known_;
};

/// Makes a patch of the witness points, if they are near enough: where rays have found no surface, which curved ones
/// nearly along the normal can hide.
void take_witness_points(const DistanceResult& at, double within, double size, ContactPatch& patch) {
  const Eigen::Vector3d way = at.point_b - at.point_a - at.distance * patch.normal;
  if (!(at.distance <= within) || !(way.norm() <= kOnNormal * size)) return;
  patch.kind = PatchKind::point;
  patch.points = {{at.point_a, at.point_b, -at.distance, 0}};
  patch.centre = 0.5 * (at.point_a + at.point_b);
  patch.error = kPlaceRounding * size;
}

/// Returns whether the surfaces are further apart than `within` everywhere, by the distance, a lower bound of the gap
/// along its normal.
bool are_apart(const DistanceResult& at, double within, double size) {
  const Eigen::Vector3d way = at.point_b - at.point_a - at.distance * at.normal;
  return at.distance > within && way.norm() <= kOnNormal * size;
}

void check(const DistanceResult& at, const PatchOptions& options) {
  if (!(options.within >= 0 && options.within <= kMaxCoordinate)) {
    kernel::refuse("contact_patch: within is " + kernel::shown(options.within) + "; accepted: a length, 0 to 1e100");
  }
  if (!(options.tolerance >= 1e-4 && options.tolerance <= 0.5)) {
    kernel::refuse("contact_patch: tolerance is " + kernel::shown(options.tolerance) + "; accepted: 1e-4 to 0.5");
  }
  if (options.max_points < 3) {
    kernel::refuse("contact_patch: max_points is " + std::to_string(options.max_points) + "; accepted: 3 or more");
  }
  const bool answered = at.status == DistanceStatus::separated || at.status == DistanceStatus::overlapping;
  if (answered && !(std::abs(at.normal.norm() - 1) <= kPoseTolerance)) {
    kernel::refuse("contact_patch: the normal has length " + kernel::shown(at.normal.norm()) + "; accepted: 1");
  }
}

}  // namespace
}  // namespace patch

const char* to_string(PatchKind kind) {
  switch (kind) {
    case PatchKind::empty:
      return "empty";
    case PatchKind::point:
      return "point";
    case PatchKind::segment:
      return "segment";
    case PatchKind::polygon:
      return "polygon";
  }
  return "?";
}

ContactPatch kernel::contact_patch(const PatchBody& a, const PatchBody& b, const DistanceResult& at,
                                   const PatchOptions& options) {
  patch::check(at, options);
  ContactPatch result;
  if (at.status != DistanceStatus::separated && at.status != DistanceStatus::overlapping) return result;
  patch::Frame frame;
  result.normal = at.normal.normalized();
  frame.axes.col(0) = result.normal.unitOrthogonal();
  frame.axes.col(1) = result.normal.cross(frame.axes.col(0));
  frame.axes.col(2) = result.normal;
  frame.origin = 0.5 * (at.point_a + at.point_b);
  const auto size_of = [&](const PatchBody& body) {
    return body.plane != nullptr ? 0 : body.bounding_radius + (body.X_WS.position() - frame.origin).norm();
  };
  const double size = size_of(a) + size_of(b);
  const double rounding = patch::kPlaceRounding * size;
  if (patch::are_apart(at, options.within + rounding, size)) return result;
  const patch::Surface upper(a, frame, 1, rounding), lower(b, frame, -1, rounding);
  patch::Outline outline(upper, lower, options, rounding);
  patch::Polygon polygon = outline.find();
  if (polygon.empty()) {
    // Bodies that touch in one point, to rounding.
    const auto heights = outline.heights(patch::Vector2d::Zero(), patch::Vector2d::Zero());
    if (heights && heights->gap() <= options.within + rounding) polygon.push_back({});
  }
  if (!polygon.empty()) {
    patch::Maker(outline, frame, a.plane != nullptr ? b.X_WS : a.X_WS, options, rounding, result)
        .make(std::move(polygon));
  }
  if (result.kind == PatchKind::empty) patch::take_witness_points(at, options.within + rounding, size, result);
  return result;
}

}  // namespace geom
