#include "derivatives/stationary.h"

#include <geom/kernel/dual_newton.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

namespace geom::kernel {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Directions are parallel if their sine is below this.
constexpr double kParallelFeatures = 1e-8;

Matrix2d across(const StationaryPair& p, const Matrix3d& H) {
  const Vector3d He = H * p.e;
  const Vector3d Hf = H * p.f;
  const double ef = 0.5 * (p.e.dot(Hf) + p.f.dot(He));
  return (Matrix2d() << p.e.dot(He), ef, ef, p.f.dot(Hf)).finished();
}

double least_eigenvalue(const Matrix2d& W) {
  return 0.5 * (W(0, 0) + W(1, 1)) - std::hypot(0.5 * (W(0, 0) - W(1, 1)), W(0, 1));
}

/// Features of both bodies while Newton's method improves normal and points.
struct Features {
  Feature a, b;
};

/// Returns the linear system of two features at a normal; nullopt if they are parallel.
std::optional<StationaryPair> system_at(const ContactBody& a, const ContactBody& b, const Features& features,
                                        const Vector3d& n) {
  StationaryPair p;
  p.n = n;
  p.a = local_contact(a, features.a, n);
  p.b = local_contact(b, features.b, -n);
  // The basis along the largest curvature radius: where that is huge, the other one keeps its digits.
  const TangentBasis basis(n);
  p.e = basis.e;
  p.f = basis.f;
  const Matrix3d H = p.a.H + p.b.H;
  const Matrix2d first = across(p, H);
  const double angle = 0.5 * std::atan2(2 * first(0, 1), first(0, 0) - first(1, 1));
  p.e = std::cos(angle) * basis.e + std::sin(angle) * basis.f;
  p.f = n.cross(p.e);
  p.H_a = across(p, p.a.H);
  p.H_b = across(p, p.b.H);
  p.curved = p.a.H.allFinite() && p.b.H.allFinite();
  p.distance = n.dot((b.centre - a.centre) + p.b.x - p.a.x);
  p.W = p.H_a + p.H_b + p.distance * Matrix2d::Identity();
  if (p.a.count + p.b.count > 2) return std::nullopt;
  for (const LocalContact* body : {&p.a, &p.b}) {
    for (std::size_t k = 0; k < body->count; ++k) {
      const Vector2d g(p.e.dot(body->slide[k]), p.f.dot(body->slide[k]));
      p.G.col(static_cast<Eigen::Index>(p.count)) = g;
      p.owner[p.count++] = body == &p.a ? 0 : 1;
    }
  }
  if (p.count == 2 && !(std::abs(p.G.determinant()) > kParallelFeatures)) return std::nullopt;
  p.stiffness = std::numeric_limits<double>::infinity();
  if (p.count == 0) p.stiffness = least_eigenvalue(p.W);
  if (p.count == 1) {
    const Vector2d free(-p.G(1, 0), p.G(0, 0));
    p.stiffness = free.dot(p.W * free) / free.squaredNorm();
  }
  return p;
}

/// Improves normal and points by Newton's method on fixed features. Returns nullopt if it does not converge, leads away
/// from the answer, or to a singular system.
std::optional<StationaryPair> improved(const ContactBody& a, const ContactBody& b, Features& features, Vector3d n,
                                       double size) {
  constexpr int kMostSteps = 10;
  constexpr double kConverged = 1e-12;
  constexpr double kStalled = 1e-9;
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    std::optional<StationaryPair> p = system_at(a, b, features, n);
    if (!p || !p->curved) return std::nullopt;
    if (!(p->stiffness > 0)) return p;
    const Vector3d gap = (b.centre - a.centre) + p->b.x - p->a.x;
    const Vector2d y(p->e.dot(gap), p->f.dot(gap));
    Vector2d c = Vector2d::Zero();
    std::array<double, 2> by_a = {}, by_b = {};
    for (std::size_t k = 0; k < p->count; ++k) {
      const LocalContact& owner = p->owner[k] == 0 ? p->a : p->b;
      c[static_cast<Eigen::Index>(k)] = -owner.slide[p->owner[k] == 0 ? k : k - p->a.count].dot(n);
    }
    const Vector2d w = p->turn<1>(y, c);
    const Vector2d rest = y - p->W * w;
    double most = w.norm();
    if (p->count > 0) {
      Vector2d t(p->G.col(0).dot(rest) / p->G.col(0).squaredNorm(), 0);
      if (p->count == 2) t = p->G.inverse() * rest;
      for (std::size_t k = 0; k < p->count; ++k) {
        if (p->owner[k] == 0) by_a[k] = t[static_cast<Eigen::Index>(k)];
        if (p->owner[k] == 1) by_b[k - p->a.count] = -t[static_cast<Eigen::Index>(k)];
      }
      slide(features.a, p->a, by_a);
      slide(features.b, p->b, by_b);
      // Points of straight features are exact after one step.
      const bool bent = features.a.kind == Feature::Kind::side || features.b.kind == Feature::Kind::side;
      if (bent) most = std::max(most, t.norm() / size);
    }
    if (!std::isfinite(most) || most > kMaxNormalStep) return std::nullopt;
    n = (n + p->e * w.x() + p->f * w.y()).normalized();
    if (most <= kConverged || (most <= kStalled && most > 0.5 * last)) return system_at(a, b, features, n);
    last = most;
  }
  return std::nullopt;
}

}  // namespace

std::optional<StationaryPair> stationary_pair(const ContactBody& a, const ContactBody& b, const DistanceResult& at,
                                              const ContactPoints& points) {
  constexpr double kSlacks[] = {1e-12, 1e-10, 1e-8, 1e-6, 1e-4};
  constexpr double kRounding = 1e-11;
  constexpr double kFarthest = 1e-2;  // change of the normal
  const double size = a.bounding_radius + b.bounding_radius;
  const double reach = std::max(at.point_a.cwiseAbs().maxCoeff(), at.point_b.cwiseAbs().maxCoeff());
  const double bound = std::isfinite(at.error_bound) ? at.error_bound : kWidestGap * size;
  Features tried;
  bool any = false;
  for (const double slack : kSlacks) {
    const double length = slack * size + 2e-15 * reach;
    const std::optional<Feature> f_a = feature_at(a, at.normal, points.a, length);
    const std::optional<Feature> f_b = feature_at(b, -at.normal, points.b, length);
    if (!f_a || !f_b || (any && tried.a.same_as(*f_a) && tried.b.same_as(*f_b))) continue;
    any = true;
    tried = {*f_a, *f_b};
    Features features = tried;
    const std::optional<StationaryPair> p = improved(a, b, features, at.normal, size);
    if (!p) continue;
    if (!((p->n - at.normal).norm() <= kFarthest)) continue;
    if (!(std::abs(p->distance - at.distance) <= 2 * bound + kRounding * (size + reach))) continue;
    if (p->stiffness <= 0) return p;
    const double margin = kFeatureMargin * size + 2e-15 * reach;
    const std::optional<Feature> again_a = feature_at(a, p->n, p->a.x, margin);
    const std::optional<Feature> again_b = feature_at(b, -p->n, p->b.x, margin);
    if (again_a && again_b && again_a->same_as(*f_a) && again_b->same_as(*f_b)) return p;
  }
  return std::nullopt;
}

bool points_are_single(const ContactBody& a, const ContactBody& b, const Vector3d& n, const ContactPoints& points,
                       double size) {
  constexpr double kNear = 1e-6;  // of the size: the support point is the witness point
  const double slack = kFeatureMargin * size;
  for (const auto& [body, out, x] : {std::tuple{&a, n, points.a}, std::tuple{&b, Vector3d(-n), points.b}}) {
    if (body->core || body->plane != nullptr) continue;
    if (!((local_contact(*body, {.kind = Feature::Kind::smooth}, out).x - x).norm() <= kNear * size)) return false;
  }
  const LocalContact free_a = free_directions(a, n, slack);
  const LocalContact free_b = free_directions(b, -n, slack);
  if (free_a.count + free_b.count > 2) return false;
  if (free_a.count != 1 || free_b.count != 1) return true;
  return free_a.slide[0].cross(free_b.slide[0]).norm() > kParallelFeatures;
}

}  // namespace geom::kernel
