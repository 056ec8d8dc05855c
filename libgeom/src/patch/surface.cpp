#include "patch/surface.h"

#include <geom/kernel/refuse.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace geom::patch {
namespace {

/// Number of steps of the search for a line between a point and a shadow.
constexpr int kShadowSteps = 60;

/// Component of a half-space's normal along the direction that is too little.
constexpr double kAlongPlane = 1e-6;

/// Slope from which on a face is a wall.
constexpr double kWall = 10;

/// Returns the indices of the corners of the convex hull of points, anticlockwise. Points that are closer to each other
/// than the tolerance count once, the highest of them; so do those that close to an edge.
std::vector<std::size_t> plane_hull(const std::vector<Vector3d>& points, double tolerance) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return points[i].z() > points[j].z(); });
  std::vector<std::size_t> distinct;
  for (const std::size_t k : order) {
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](std::size_t other) {
      return (points[other].head<2>() - points[k].head<2>()).norm() <= tolerance;
    });
    if (!known) distinct.push_back(k);
  }
  const auto place = [&](std::size_t k) { return Vector2d(points[k].head<2>()); };
  std::sort(distinct.begin(), distinct.end(), [&](std::size_t i, std::size_t j) {
    const Vector2d p = place(i), q = place(j);
    return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y());
  });
  std::vector<std::size_t> hull;
  const auto append = [&](std::size_t k, std::size_t least) {
    while (hull.size() > least) {
      const Vector2d from = place(hull[hull.size() - 2]), edge = place(k) - from;
      if (cross(edge, place(hull.back()) - from) < -tolerance * edge.norm()) break;
      hull.pop_back();
    }
    hull.push_back(k);
  };
  for (const std::size_t k : distinct) append(k, 1);
  const std::size_t lower = hull.size();
  for (auto k = distinct.rbegin(); k != distinct.rend(); ++k) {
    if (*k != hull.back()) append(*k, lower);
  }
  hull.pop_back();
  return hull;
}

/// Returns the normal that is steepest along z by a clear margin. Where two are about as steep, a body that turns a
/// little would go from one to the other.
std::optional<std::size_t> flattest_of(const std::vector<Vector3d>& normals) {
  constexpr double kMargin = 0.01;
  std::size_t flattest = 0;
  double second = -1;
  for (std::size_t f = 1; f < normals.size(); ++f) {
    const double z = normals[f].z(), most = normals[flattest].z();
    second = std::max(second, std::min(z, most));
    if (z > most) flattest = f;
  }
  return normals[flattest].z() > second + kMargin ? std::optional(flattest) : std::nullopt;
}

}  // namespace

Surface::Surface(const kernel::PatchBody& body, const Frame& frame, double sign, double tolerance)
    : body_(body), frame_(frame), sign_(sign), tolerance_(tolerance) {
  if (body.plane != nullptr) {
    const Vector3d normal = local(body.X_WS.rotation() * body.plane->normal());
    if (!(normal.z() > kAlongPlane)) {
      kernel::refuse("contact_patch: the normal points into a half-space or along its plane; accepted: out of it");
    }
    const Vector3d on = body.X_WS.to_world(body.plane->offset() * body.plane->normal());
    Vector3d place = frame.from_world(on);
    place.z() *= sign;
    plane_ = Tangent{normal.dot(place) / normal.z(), -normal.head<2>() / normal.z(), 0};
    return;
  }
  middle_ = frame.from_world(body.X_WS.position()).head<2>();
  const double centre = sign * frame.from_world(body.X_WS.position()).z();
  top_ = centre + body.bounding_radius;
  bottom_ = centre - body.bounding_radius;
  if (!kernel::is_polytope(body.core)) return;
  if (body.core->kind == kernel::CoreKind::hull) {
    read_hull(*body.core->hull);
  } else {
    read_box(body.core->half);
  }
}

Vector3d Surface::local(const Vector3d& world_vector) const {
  Vector3d v = frame_.axes.transpose() * world_vector;
  v.z() *= sign_;
  return v;
}

void Surface::read_hull(const kernel::Hull& hull) {
  std::vector<Vector3d> corners;
  for (Eigen::Index k = 0; k < hull.vertices.rows(); ++k) corners.emplace_back(hull.vertices.row(k).transpose());
  read_polytope(std::move(corners), hull.normals, hull.offsets, hull.faces);
}

void Surface::read_box(const Vector3d& half) {
  // Face 2 i is that at +half[i], face 2 i + 1 the opposite one.
  std::vector<Vector3d> corners, normals;
  std::vector<double> offsets;
  std::vector<std::vector<int>> faces(6);
  for (int k = 0; k < 8; ++k) {
    Vector3d corner = half;
    for (int i = 0; i < 3; ++i) {
      const bool is_low = (k >> i & 1) == 0;
      if (is_low) corner[i] = -half[i];
      faces[2 * static_cast<std::size_t>(i) + (is_low ? 1U : 0U)].push_back(k);
    }
    corners.push_back(corner);
  }
  for (int i = 0; i < 3; ++i) {
    for (const double side : {1.0, -1.0}) {
      normals.emplace_back(side * Vector3d::Unit(i));
      offsets.push_back(half[i]);
    }
  }
  read_polytope(std::move(corners), std::move(normals), std::move(offsets), faces);
}

void Surface::read_polytope(std::vector<Vector3d> corners, std::vector<Vector3d> normals, std::vector<double> offsets,
                            const std::vector<std::vector<int>>& faces) {
  Vector3d origin = frame_.from_world(body_.X_WS.position());
  origin.z() *= sign_;
  top_ = -std::numeric_limits<double>::infinity();
  bottom_ = -top_;
  for (Vector3d& corner : corners) {
    corner = origin + local(body_.X_WS.rotation() * corner);
    top_ = std::max(top_, corner.z());
    bottom_ = std::min(bottom_, corner.z());
  }
  for (std::size_t f = 0; f < normals.size(); ++f) {
    normals[f] = local(body_.X_WS.rotation() * normals[f]);
    offsets[f] += normals[f].dot(origin);
  }
  const std::optional<std::size_t> flattest = flattest_of(normals);
  for (std::size_t f = 0; f < normals.size(); ++f) {
    if (!(normals[f].z() > std::numeric_limits<double>::epsilon())) continue;
    const Vector2d slope = -normals[f].head<2>() / normals[f].z();
    // Planes are moved outwards by the tolerance: a steep one, whose height is uncertain, does not count where a
    // flatter one is lower.
    const double height = offsets[f] / normals[f].z() + tolerance_ * slope.norm();
    const std::uint32_t feature = f == flattest ? 0U : static_cast<std::uint32_t>(f) + 1;
    facets_.push_back({slope, height, feature, slope.norm() >= kWall});
  }
  read_outline(corners, normals, faces);
}

void Surface::read_outline(const std::vector<Vector3d>& corners, const std::vector<Vector3d>& normals,
                           const std::vector<std::vector<int>>& faces) {
  const std::vector<std::size_t> hull = plane_hull(corners, tolerance_);
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const std::size_t from = hull[i], to = hull[(i + 1) % hull.size()];
    const Vector2d p = corners[from].head<2>(), q = corners[to].head<2>();
    const Vector2d along = (q - p).normalized();
    Line line{Vector2d(along.y(), -along.x()), 0, 0, true};
    line.reach = std::max(line.normal.dot(p), line.normal.dot(q));
    // A side of the outline is named by the steepest face that has both corners, which bounds the patch if the body is
    // tilted the other way. Corners may be those of an edge or, where more are in one line, any of a face.
    double steepest = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto has = [&](std::size_t k) {
        return std::find(faces[f].begin(), faces[f].end(), static_cast<int>(k)) != faces[f].end();
      };
      if (!(std::abs(normals[f].z()) < steepest) || !has(from) || !has(to)) continue;
      steepest = std::abs(normals[f].z());
      line.feature = static_cast<std::uint32_t>(f) + 1;
    }
    outline_.push_back(line);
  }
}

Vector2d Surface::support(const Vector2d& direction) const {
  const Vector3d n = frame_.axes.leftCols<2>() * direction;
  const Support s = body_.support(body_.shape, body_.X_WS.rotation().transpose() * n);
  return frame_.from_world(body_.X_WS.to_world(s.point)).head<2>();
}

double Surface::reach(const Vector2d& direction) const {
  return direction.dot(support(direction));
}

std::optional<Line> Surface::beyond(const Vector2d& x) const {
  if (plane_) return std::nullopt;
  if (outline_.empty()) return beyond_smooth(x);
  const Line* worst = nullptr;
  double most = tolerance_;
  for (const Line& line : outline_) {
    const double excess = line.normal.dot(x) - line.reach;
    if (excess > most) {
      most = excess;
      worst = &line;
    }
  }
  return worst == nullptr ? std::nullopt : std::optional(*worst);
}

/// Searches the point of the shadow that is closest to x among support points, a pair of which is kept.
std::optional<Line> Surface::beyond_smooth(const Vector2d& x) const {
  Vector2d direction = x - middle_;
  if (direction.isZero(0)) return std::nullopt;
  Vector2d best = middle_;
  std::optional<Line> line;  // that with x furthest beyond it
  double most = tolerance_;
  for (int step = 0; step < kShadowSteps; ++step) {
    direction.normalize();
    const Vector2d s = support(direction);
    const double excess = direction.dot(x - s);
    if (excess > most) {
      most = excess;
      line = Line{direction, direction.dot(s), 1, false};
    }
    // A line at half of the distance or more cuts enough.
    if (line && most > 0.5 * (x - best).norm()) break;
    const Vector2d next = closest_on(best, s, x);
    if ((next - best).norm() <= 1e-3 * tolerance_) break;
    best = next;
    direction = x - best;
    if (direction.norm() <= tolerance_) break;
  }
  return line;
}

std::optional<Tangent> Surface::lowest(const Vector2d& x, bool with_tops, bool with_walls) const {
  const Facet* lowest = nullptr;
  double height = 0;
  for (const Facet& facet : facets_) {
    if (!(facet.is_wall ? with_walls : with_tops)) continue;
    const double z = facet.height + facet.slope.dot(x);
    if (lowest != nullptr && !(z < height)) continue;
    lowest = &facet;
    height = z;
  }
  if (lowest == nullptr) return std::nullopt;
  return Tangent{std::clamp(height, bottom_, top_), lowest->slope, lowest->feature};
}

std::optional<Tangent> Surface::top(const Vector2d& x) const {
  return plane_ ? at(x) : lowest(x, true, false);
}

std::optional<Line> Surface::past_rim(const Vector2d& x) const {
  std::optional<Line> worst = beyond(x);
  const std::optional<Tangent> flat = top(x);
  if (!flat) return worst;
  double most = worst ? worst->normal.dot(x) - worst->reach : tolerance_;
  for (const Facet& facet : facets_) {
    if (!facet.is_wall) continue;
    const Vector2d gradient = flat->slope - facet.slope;
    const double steepness = gradient.norm();
    const double excess = (flat->height - facet.height - facet.slope.dot(x)) / steepness;
    if (!(excess > most)) continue;
    most = excess;
    const Vector2d normal = gradient / steepness;
    worst = Line{normal, normal.dot(x) - excess, facet.feature, true};
  }
  return worst;
}

std::optional<std::uint32_t> Surface::side_along(const Vector2d& from, const Vector2d& to, double slack) const {
  const auto near = [&](const Line& line, const Vector2d& x) {
    return std::abs(line.normal.dot(x) - line.reach) <= slack;
  };
  for (const Line& line : outline_) {
    if (near(line, from) && near(line, to)) return line.feature;
  }
  return std::nullopt;
}

std::optional<Tangent> Surface::at(const Vector2d& x) const {
  if (plane_) return Tangent{plane_->height + plane_->slope.dot(x), plane_->slope, 0};
  if (!facets_.empty()) return lowest(x, true, true);
  const Vector3d above(x.x(), x.y(), sign_ * (top_ + 0.1 * (top_ - bottom_)));
  const Vector3d down = -sign_ * frame_.axes.col(2);
  const RayHit hit = body_.ray(body_.shape, body_.X_WS, frame_.to_world(above), down);
  if (hit.status != RayStatus::hit) return std::nullopt;
  const Vector3d normal = local(hit.normal);
  if (!(normal.z() > std::numeric_limits<double>::epsilon())) return std::nullopt;
  return Tangent{sign_ * frame_.from_world(hit.point).z(), -normal.head<2>() / normal.z(), 1};
}

}  // namespace geom::patch
