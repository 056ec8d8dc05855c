#include <geom/any_convex.h>

#include <algorithm>
#include <cmath>

namespace geom {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// A user's shape, of which nothing is known but the interface.
class ErasedBody {
 public:
  explicit ErasedBody(const AnyConvex::Concept& shape) : shape_(shape) {}
  Support support(const Vector3d& n) const { return shape_.support(n); }
  Matrix3d support_hessian(const Vector3d& n) const { return shape_.support_hessian(n); }
  double bounding_radius() const { return shape_.bounding_radius(); }
  double inscribed_radius() const { return shape_.inscribed_radius(); }
  double min_curvature_radius() const { return shape_.min_curvature_radius(); }
  bool contains(const Vector3d& x) const { return shape_.contains(x); }

 private:
  const AnyConvex::Concept& shape_;
};

/// Returns f(body, pose, skin) of an Ellipsoid, a Superellipsoid, a CoreBody, which has the skin, or an ErasedBody.
template <class F>
decltype(auto) with_part(const AnyConvex& any, const Pose& X_WB, F&& f) {
  const AnyConvex::Part& part = any.part();
  const Pose X_WI = X_WB * part.X_BI;
  if (std::optional<kernel::CoreView> core = part.shape->core()) {
    core->radius += part.skin;
    return f(kernel::CoreBody(*core, part.shape->inscribed_radius() + part.skin), X_WI, 0.0);
  }
  if (const Ellipsoid* ellipsoid = part.shape->ellipsoid()) return f(*ellipsoid, X_WI, part.skin);
  if (const Superellipsoid* superellipsoid = part.shape->superellipsoid()) return f(*superellipsoid, X_WI, part.skin);
  return f(ErasedBody(*part.shape), X_WI, part.skin);
}

/// Returns f(body_a, pose_a, skin_a, body_b, pose_b, skin_b).
template <class F>
decltype(auto) with_parts(const AnyConvex& a, const Pose& X_WA, const AnyConvex& b, const Pose& X_WB, const F& f) {
  return with_part(a, X_WA, [&](const auto& A, const Pose& X_A, double skin_a) -> decltype(auto) {
    return with_part(b, X_WB, [&](const auto& B, const Pose& X_B, double skin_b) -> decltype(auto) {
      return f(A, X_A, skin_a, B, X_B, skin_b);
    });
  });
}

}  // namespace

Support AnyConvex::support(const Vector3d& n) const {
  const Support s = part_.shape->support(part_.X_BI.rotation().transpose() * n);
  const double length = n.norm();
  return {s.height + n.dot(part_.X_BI.position()) + part_.skin * length,
          part_.X_BI.to_world(s.point) + part_.skin / length * n};
}

Matrix3d AnyConvex::support_hessian(const Vector3d& n) const {
  const Matrix3d& R = part_.X_BI.rotation();
  return R * part_.shape->support_hessian(R.transpose() * n) * R.transpose() + kernel::ball_hessian(part_.skin, n);
}

double AnyConvex::bounding_radius() const {
  return part_.shape->bounding_radius() + part_.X_BI.position().norm() + part_.skin;
}

double AnyConvex::inscribed_radius() const {
  return std::max(0.0, part_.shape->inscribed_radius() + part_.skin - part_.X_BI.position().norm());
}

double AnyConvex::min_curvature_radius() const {
  return part_.shape->min_curvature_radius() + part_.skin;
}

DistanceResult distance(const AnyConvex& a, const Pose& X_WA, const AnyConvex& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  return with_parts(a, X_WA, b, X_WB,
                    [&](const auto& A, const Pose& X_A, double skin_a, const auto& B, const Pose& X_B, double skin_b) {
                      return kernel::with_skins(distance(A, X_A, B, X_B, options), skin_a, skin_b);
                    });
}

double distance_lower_bound(const AnyConvex& a, const Pose& X_WA, const AnyConvex& b, const Pose& X_WB,
                            const Vector3d& n) {
  return with_parts(a, X_WA, b, X_WB,
                    [&](const auto& A, const Pose& X_A, double skin_a, const auto& B, const Pose& X_B, double skin_b) {
                      return distance_lower_bound(A, X_A, B, X_B, n) - (1 + kLowerBoundRounding) * (skin_a + skin_b);
                    });
}

Answer overlap(const AnyConvex& a, const Pose& X_WA, const AnyConvex& b, const Pose& X_WB, const Vector3d& start) {
  return with_parts(a, X_WA, b, X_WB,
                    [&](const auto& A, const Pose& X_A, double skin_a, const auto& B, const Pose& X_B, double skin_b) {
                      if (skin_a == 0 && skin_b == 0) return overlap(A, X_A, B, X_B, start);
                      const Vector3d r = X_B.position() - X_A.position();
                      if (distance_lower_bound(a, X_WA, b, X_WB, kernel::is_warm(start) ? start : r) > 0)
                        return Answer::no;
                      const double size = r.norm() + A.bounding_radius() + B.bounding_radius() + skin_a + skin_b;
                      for (const Penetration penetration : {Penetration::local, Penetration::global}) {
                        const DistanceResult d =
                            distance(a, X_WA, b, X_WB, {.start = start, .penetration = penetration});
                        if (d.status == DistanceStatus::separated) return d.distance > 0 ? Answer::no : Answer::yes;
                        if (d.status != DistanceStatus::overlapping) continue;
                        if (d.distance + d.error_bound < 0 || -d.distance <= kRoundingFactor * size) return Answer::yes;
                      }
                      return Answer::unknown;
                    });
}

ClosestPoint closest_point(const AnyConvex& shape, const Pose& X_WB, const Vector3d& p_W) {
  return with_part(shape, X_WB, [&](const auto& body, const Pose& X, double skin) {
    ClosestPoint closest = closest_point(body, X, p_W);
    closest.distance -= skin;
    closest.point += skin * closest.normal;
    if (closest.status == DistanceStatus::separated && closest.distance < 0) {
      closest.status = DistanceStatus::overlapping;
    }
    return closest;
  });
}

bool contains(const AnyConvex& shape, const Pose& X_WB, const Vector3d& p_W) {
  if (!kernel::is_within_reach(p_W)) return false;
  return with_part(shape, X_WB, [&](const auto& body, const Pose& X, double skin) {
    if (kernel::holds_point(body, X.to_body(p_W))) return true;
    constexpr bool kTells = !std::same_as<std::decay_t<decltype(body)>, ErasedBody>;
    if (kTells && skin == 0) return false;
    return closest_point(shape, X_WB, p_W).distance <= 0;
  });
}

RayHit ray_cast(const AnyConvex& shape, const Pose& X_WB, const Vector3d& origin, const Vector3d& direction) {
  return with_part(shape, X_WB, [&](const auto& body, const Pose& X, double skin) {
    if (skin == 0) return ray_cast(body, X, origin, direction);
    return ray_cast<AnyConvex>(shape, X_WB, origin, direction);
  });
}

}  // namespace geom
