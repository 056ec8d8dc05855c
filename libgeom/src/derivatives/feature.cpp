#include "derivatives/feature.h"

#include <geom/kernel/core.h>
#include <geom/kernel/dual_newton.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Kind = Feature::Kind;

/// Normal and point of a body in the axes of its core, and the slack.
struct InCore {
  Vector3d n, x;
  double slack;
};

/// Returns a feature of the core's axes in those of the world.
Feature placed(const ContactBody& body, Feature f) {
  const Matrix3d& R = body.X_WS.rotation();
  f.point = R * f.point + (body.X_WS.position() - body.centre);
  f.along = R * f.along;
  return f;
}

std::optional<Feature> vertex_feature(const Vector3d& v, int id, const InCore& at) {
  if (!((at.x - v).norm() <= at.slack)) return std::nullopt;
  return Feature{.kind = Kind::fixed, .id = id, .point = v};
}

/// Returns the edge from p to q if the point is between its ends.
std::optional<Feature> edge_feature(const Vector3d& p, const Vector3d& q, int id, const InCore& at) {
  const double length = (q - p).norm();
  const Vector3d along = (q - p) / length;
  const double t = (at.x - p).dot(along);
  const Vector3d foot = p + t * along;
  if (!(t > at.slack && t < length - at.slack) || !((at.x - foot).norm() <= at.slack)) return std::nullopt;
  return Feature{.kind = Kind::edge, .id = id, .point = foot, .along = along};
}

/// Returns the feature of a box, also of a segment: a box with half extents 0.
std::optional<Feature> box_feature(const Vector3d& half, const InCore& at) {
  Vector3d foot = at.x;
  Vector3d sign;
  int free = 0;
  int count = 0;
  int fixed = 0;
  int id = 0;
  for (int k = 0; k < 3; ++k) {
    sign[k] = std::copysign(1.0, at.n[k]);
    if (half[k] > 0 && half[k] * std::abs(at.n[k]) <= at.slack) {
      if (!(std::abs(at.x[k]) < half[k] - at.slack)) return std::nullopt;
      free = k;
      ++count;
      id = 4 * id + 2;
    } else {
      foot[k] = sign[k] * half[k];
      if (half[k] > 0 || fixed == 0) fixed = k;
      id = 4 * id + (half[k] > 0 && sign[k] > 0 ? 1 : 0);
    }
  }
  if (count > 2 || !((at.x - foot).norm() <= at.slack)) return std::nullopt;
  if (count == 0) return Feature{.kind = Kind::fixed, .id = id, .point = foot};
  if (count == 1) return Feature{.kind = Kind::edge, .id = id, .point = foot, .along = Vector3d::Unit(free)};
  return Feature{.kind = Kind::plane, .id = id, .point = foot, .along = sign[fixed] * Vector3d::Unit(fixed)};
}

/// Vertices of a hull that are furthest along a normal.
class FurthestVertices {
 public:
  FurthestVertices(const Hull& hull, const InCore& at)
      : hull_(hull), n_(at.n), least_(n_.dot(vertex(support_vertex(hull, at.n))) - at.slack) {}

  Vector3d vertex(int k) const { return hull_.vertices.row(k).transpose(); }
  bool has(int k) const { return n_.dot(vertex(k)) >= least_; }
  bool has_face(int f) const {
    const std::vector<int>& face = hull_.faces[static_cast<std::size_t>(f)];
    return std::all_of(face.begin(), face.end(), [this](int k) { return has(k); });
  }

 private:
  const Hull& hull_;
  Vector3d n_;
  double least_;
};

/// Returns the face of a hull, with all those in its plane, if the point is inside.
std::optional<Feature> face_feature(const Hull& hull, const FurthestVertices& furthest, int f, const InCore& at) {
  const Vector3d& normal = hull.normals[static_cast<std::size_t>(f)];
  const double above = normal.dot(at.x) - hull.offsets[static_cast<std::size_t>(f)];
  if (!(std::abs(above) <= at.slack)) return std::nullopt;
  for (const HullEdge& edge : hull.edges) {
    if (!furthest.has(edge.from) || !furthest.has(edge.to)) continue;
    for (const int side : {edge.left, edge.right}) {
      if (furthest.has_face(side)) continue;
      const Vector3d& beside = hull.normals[static_cast<std::size_t>(side)];
      const double inside = hull.offsets[static_cast<std::size_t>(side)] - beside.dot(at.x);
      if (!(inside > at.slack * normal.cross(beside).norm())) return std::nullopt;
    }
  }
  return Feature{.kind = Kind::plane, .id = f, .point = at.x - above * normal, .along = normal};
}

std::optional<Feature> hull_feature(const Hull& hull, const InCore& at) {
  const FurthestVertices furthest(hull, at);
  int count = 0;
  int last = 0;
  for (int k = 0; k < static_cast<int>(hull.vertices.rows()); ++k) {
    if (!furthest.has(k)) continue;
    last = k;
    ++count;
  }
  if (count == 1) return vertex_feature(furthest.vertex(last), last, at);
  if (count == 2) {
    for (std::size_t e = 0; e < hull.edges.size(); ++e) {
      const HullEdge& edge = hull.edges[e];
      if (furthest.has(edge.from) && furthest.has(edge.to)) {
        return edge_feature(furthest.vertex(edge.from), furthest.vertex(edge.to), static_cast<int>(e), at);
      }
    }
    return std::nullopt;
  }
  for (int f = 0; f < static_cast<int>(hull.faces.size()); ++f) {
    if (furthest.has_face(f)) return face_feature(hull, furthest, f, at);
  }
  return std::nullopt;
}

/// Returns how much further the upper rim of a frustum reaches along n than the lower one.
double rise_of(const CoreView& core, const Vector3d& n) {
  const auto& [low, high] = core.disc;
  return (high.z - low.z) * n.z() + (high.radius - low.radius) * std::hypot(n.x(), n.y());
}

std::optional<Feature> frustum_feature(const CoreView& core, const InCore& at) {
  const auto& [low, high] = core.disc;
  const double across = std::hypot(at.n.x(), at.n.y());
  const double out = std::hypot(at.x.x(), at.x.y());
  const int end = at.n.z() > 0 ? 1 : 0;
  const CoreDisc& cap = core.disc[static_cast<std::size_t>(end)];
  if (cap.radius > 0 && cap.radius * across <= at.slack) {
    if (!(std::abs(at.x.z() - cap.z) <= at.slack) || !(out < cap.radius - at.slack)) return std::nullopt;
    return Feature{.kind = Kind::plane,
                   .id = end,
                   .point = {at.x.x(), at.x.y(), cap.z},
                   .along = Vector3d(0, 0, end == 1 ? 1 : -1)};
  }
  const double rise = rise_of(core, at.n);
  if (std::abs(rise) <= at.slack) {
    const double height = high.z - low.z;
    const double share = (at.x.z() - low.z) / height;
    const double radius = low.radius + share * (high.radius - low.radius);
    const double margin = at.slack / height;
    if (!(share > margin && share < 1 - margin) || !(std::abs(out - radius) <= at.slack)) return std::nullopt;
    return Feature{.kind = Kind::side, .share = share};
  }
  const int id = rise < 0 ? 0 : 1;
  const CoreDisc& disc = core.disc[static_cast<std::size_t>(id)];
  if (disc.radius == 0) return vertex_feature({0, 0, disc.z}, id, at);
  if (!(std::abs(at.x.z() - disc.z) <= at.slack) || !(std::abs(out - disc.radius) <= at.slack)) return std::nullopt;
  return Feature{.kind = Kind::rim, .id = id};
}

std::optional<Feature> core_feature(const CoreView& core, const InCore& at) {
  switch (core.kind) {
    case CoreKind::point:
    case CoreKind::segment:
    case CoreKind::box:
      return box_feature(core.half, at);
    case CoreKind::hull:
      return hull_feature(*core.hull, at);
    case CoreKind::frustum:
      return frustum_feature(core, at);
  }
  return std::nullopt;
}

double ball_of(const ContactBody& body) {
  return body.skin + (body.core ? body.core->radius : 0);
}

void add_ball(LocalContact& at, double radius, const Vector3d& n) {
  at.x += radius * n;
  at.H += radius * (Matrix3d::Identity() - n * n.transpose());
}

void free_across(LocalContact& at, const Vector3d& normal) {
  const TangentBasis basis(normal);
  at.count = 2;
  at.slide = {basis.e, basis.f};
}

/// Sets the point of a rim, or between both of them, that belongs to n.
void set_round(const ContactBody& body, const Feature& feature, const Vector3d& n, LocalContact& at) {
  const CoreView& core = *body.core;
  const Matrix3d& R = body.X_WS.rotation();
  const Vector3d a = R.col(2);
  const Vector3d across = n.dot(R.col(0)) * R.col(0) + n.dot(R.col(1)) * R.col(1);
  const double length = across.norm();
  const Vector3d e = across / length;
  const Vector3d tangent = a.cross(e);
  const auto& [low, high] = core.disc;
  CoreDisc disc = core.disc[static_cast<std::size_t>(feature.id)];
  if (feature.kind == Kind::side) {
    disc = {low.z + feature.share * (high.z - low.z), low.radius + feature.share * (high.radius - low.radius)};
    const Vector3d line = (high.z - low.z) * a + (high.radius - low.radius) * e;
    at.count = 1;
    at.slide[0] = line.normalized();
    at.per_unit[0] = 1 / line.norm();
  }
  at.x = (body.X_WS.position() - body.centre) + disc.z * a + disc.radius * e;
  at.H = disc.radius / length * tangent * tangent.transpose();
}

}  // namespace

std::optional<Feature> feature_at(const ContactBody& body, const Vector3d& n, const Vector3d& x, double slack) {
  if (body.plane != nullptr) {
    const Vector3d normal = body.X_WS.rotation() * body.plane->normal();
    const Vector3d at = x + (body.centre - body.X_WS.position());
    return Feature{.kind = Kind::plane, .point = x - (normal.dot(at) - body.plane->offset()) * normal, .along = normal};
  }
  if (!body.core) return Feature{.kind = Kind::smooth};
  const Matrix3d& R = body.X_WS.rotation();
  const Vector3d inner = x - ball_of(body) * n - (body.X_WS.position() - body.centre);
  const std::optional<Feature> f = core_feature(*body.core, {R.transpose() * n, R.transpose() * inner, slack});
  if (!f) return std::nullopt;
  return placed(body, *f);
}

LocalContact local_contact(const ContactBody& body, const Feature& feature, const Vector3d& n) {
  LocalContact at;
  at.x = feature.point;
  at.H = Matrix3d::Zero();
  switch (feature.kind) {
    case Kind::fixed:
      break;
    case Kind::smooth: {
      const Matrix3d& R = body.X_WS.rotation();
      const Vector3d n_S = R.transpose() * n;
      at.x = R * body.support(body.shape, n_S).point + (body.X_WS.position() - body.centre);
      at.H = R * body.hessian(body.shape, n_S) * R.transpose();
      break;
    }
    case Kind::edge:
      at.count = 1;
      at.slide[0] = feature.along;
      break;
    case Kind::plane:
      free_across(at, feature.along);
      break;
    case Kind::rim:
    case Kind::side:
      set_round(body, feature, n, at);
      break;
  }
  add_ball(at, ball_of(body), n);
  return at;
}

void slide(Feature& feature, const LocalContact& at, const std::array<double, 2>& by) {
  for (std::size_t k = 0; k < at.count; ++k) {
    if (feature.kind == Kind::side) {
      feature.share += by[k] * at.per_unit[k];
    } else {
      feature.point += by[k] * at.slide[k];
    }
  }
}

LocalContact free_directions(const ContactBody& body, const Vector3d& n, double slack) {
  LocalContact at;
  if (body.plane != nullptr) free_across(at, n);
  if (!body.core) return at;
  const CoreView& core = *body.core;
  const Matrix3d& R = body.X_WS.rotation();
  const Vector3d n_S = R.transpose() * n;
  const auto add = [&](const Vector3d& v) {
    const Vector3d u = R * v;
    const Vector3d first = at.count > 0 ? Vector3d(u - u.dot(at.slide[0]) * at.slide[0]) : u;
    if (at.count < 2 && first.norm() > 1e-6) at.slide[at.count++] = first.normalized();
  };
  if (core.kind == CoreKind::frustum) {
    const double across = std::hypot(n_S.x(), n_S.y());
    if (core.disc[n_S.z() > 0 ? 1 : 0].radius * across <= slack && core.disc[n_S.z() > 0 ? 1 : 0].radius > 0) {
      free_across(at, n);
    } else if (std::abs(rise_of(core, n_S)) <= slack && across > 0) {
      const auto& [low, high] = core.disc;
      const Vector3d e(n_S.x() / across, n_S.y() / across, 0);
      add(((high.z - low.z) * Vector3d::UnitZ() + (high.radius - low.radius) * e).normalized());
    }
  } else if (core.kind == CoreKind::hull) {
    const FurthestVertices furthest(*core.hull, {n_S, Vector3d::Zero(), slack});
    for (const HullEdge& edge : core.hull->edges) {
      if (furthest.has(edge.from) && furthest.has(edge.to)) {
        add((furthest.vertex(edge.to) - furthest.vertex(edge.from)).normalized());
      }
    }
  } else {
    for (int k = 0; k < 3; ++k) {
      if (core.half[k] > 0 && core.half[k] * std::abs(n_S[k]) <= slack) add(Vector3d::Unit(k));
    }
  }
  return at;
}

}  // namespace geom::kernel
