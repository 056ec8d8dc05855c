#include "contact/body_shapes.h"
#include "contact/convex/body.h"

#include <ed/shape.h>
#include <ed/tolerances.h>

#include <geom/any_shape.h>
#include <geom/kernel/any_body.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace ed {
namespace {

using Eigen::Vector3d;

/// Calls f with the shape inside.
template <class F>
decltype(auto) with(const BodyShape& shape, F&& f) {
  return std::visit(std::forward<F>(f), shape);
}

[[noreturn]] void refuse(const std::string& name, const std::string& what, double value, const std::string& accepted) {
  std::ostringstream message;
  message << "shape " << name << ": " << what << " is " << value << "; accepted: " << accepted;
  throw std::invalid_argument(message.str());
}

/// Returns the body's axes to both sides, and others spread evenly, on a spiral.
std::vector<Vector3d> directions_to_check() {
  constexpr int kSpread = 64;
  constexpr double kGoldenAngle = 2.39996322972865332;
  std::vector<Vector3d> result;
  result.reserve(6 + kSpread);
  for (int k = 0; k < 6; ++k) result.emplace_back((k < 3 ? 1.0 : -1.0) * Vector3d::Unit(k % 3));
  for (int k = 0; k < kSpread; ++k) {
    const double z = 1 - (2 * k + 1.0) / kSpread;
    const double across = std::sqrt(1 - z * z);
    result.emplace_back(across * std::cos(kGoldenAngle * k), across * std::sin(kGoldenAngle * k), z);
  }
  return result;
}

/// Returns the answer for (B, A) of one for (A, B).
geom::DistanceResult reversed(geom::DistanceResult result) {
  result.normal = -result.normal;
  std::swap(result.point_a, result.point_b);
  return result;
}

/// Returns the distance by A's own method, if it has one that knows the pair.
std::optional<geom::DistanceResult> own_distance(const BodyShape& a, const geom::Pose& X_WA, const BodyShape& b,
                                                 const geom::Pose& X_WB, const geom::DistanceOptions& options) {
  const auto* custom = std::get_if<CustomShape>(&a);
  if (custom == nullptr || !custom->pair_distance()) return std::nullopt;
  return custom->pair_distance()(X_WA, b, X_WB, options);
}

std::string along(const Vector3d& n) {
  std::ostringstream text;
  text << " along (" << n.x() << ", " << n.y() << ", " << n.z() << ")";
  return text.str();
}

}  // namespace

void CustomShape::check() {
  bounding_radius_ = shape_->bounding_radius();
  inscribed_radius_ = shape_->inscribed_radius();
  min_curvature_radius_ = shape_->min_curvature_radius();
  constexpr double kBall = 4.18879020478639098;  // 4 pi / 3
  constexpr double kRounding = 1e-9;
  constexpr double kAnyAngle = 1;  // none by which polygons turn into themselves
  const double R = bounding_radius_;
  const double r = inscribed_radius_;
  if (!(R > 0) || !std::isfinite(R)) refuse(name(), "bounding_radius()", R, "a positive number");
  if (!(r > 0 && r <= R * (1 + kRounding))) {
    refuse(name(), "inscribed_radius()", r, "positive, at most the bounding radius");
  }
  if (!(min_curvature_radius_ >= 0 && min_curvature_radius_ <= r * (1 + kRounding))) {
    refuse(name(), "min_curvature_radius()", min_curvature_radius_, "0 to the inscribed radius");
  }
  if (symmetry_axis() && (*symmetry_axis() < 0 || *symmetry_axis() > 2)) {
    refuse(name(), "symmetry_axis", *symmetry_axis(), "0, 1 or 2");
  }
  for (const Vector3d& n : directions_to_check()) {
    const double height = support(n).height;
    if (!(height >= r * (1 - kRounding) && height <= R * (1 + kRounding))) {
      refuse(name(), "the support height" + along(n), height, "between the inscribed and the bounding radius");
    }
    const auto differs = [&](const Vector3d& m) { return std::abs(support(m).height - height) > kRounding * R; };
    if (centrally_symmetric() && differs(-n)) {
      refuse(name(), "centrally_symmetric", 1, "false: the support heights to both sides differ" + along(n));
    }
    if (!symmetry_axis()) continue;
    const Vector3d axis = Vector3d::Unit(*symmetry_axis());
    if (differs(Eigen::AngleAxisd(kAnyAngle, axis) * n)) {
      refuse(name(), "symmetry_axis", *symmetry_axis(), "none: a turn about it changes the support height" + along(n));
    }
  }
  // Checked last: wrong radii, of which the heights tell, would make a right volume impossible.
  if (!(volume() >= kBall * r * r * r * (1 - kRounding) && volume() <= kBall * R * R * R * (1 + kRounding))) {
    refuse(name(), "volume", volume(), "between those of the inscribed and the bounding sphere");
  }
}

double bounding_radius(const BodyShape& shape) {
  return with(shape, [](const auto& s) { return s.bounding_radius(); });
}

double inscribed_radius(const BodyShape& shape) {
  return with(shape, [](const auto& s) { return s.inscribed_radius(); });
}

bool is_sphere(const BodyShape& shape) {
  return bounding_radius(shape) == inscribed_radius(shape);
}

double volume(const BodyShape& shape) {
  return with(shape, [](const auto& s) { return s.volume(); });
}

geom::Support support(const BodyShape& shape, const Vector3d& n) {
  return geom::kernel::with_body(shape, [&n](const auto& s) { return geom::Support(s.support(n)); });
}

std::optional<int> symmetry_axis(const BodyShape& shape) {
  return with(shape, [](const auto& s) { return s.symmetry_axis(); });
}

bool is_spheroid(const BodyShape& shape) {
  return std::holds_alternative<geom::Ellipsoid>(shape) && symmetry_axis(shape);
}

Vector3d half_extents(const BodyShape& shape) {
  Vector3d result;
  for (int k = 0; k < 3; ++k) {
    const Vector3d e = Vector3d::Unit(k);
    result[k] = std::max(support(shape, e).height, support(shape, -e).height);
  }
  return result;
}

geom::DistanceResult distance(const BodyShape& a, const geom::Pose& X_WA, const BodyShape& b, const geom::Pose& X_WB,
                              const geom::DistanceOptions& options) {
  if (const auto own = own_distance(a, X_WA, b, X_WB, options)) return *own;
  geom::DistanceOptions from_b = options;
  from_b.start = -options.start;
  if (const auto own = own_distance(b, X_WB, a, X_WA, from_b)) return reversed(*own);
  const auto core_a = internal::core_of(a);
  const auto core_b = core_a ? internal::core_of(b) : std::nullopt;
  if (core_b) return geom::kernel::core_distance(*core_a, X_WA, *core_b, X_WB, options);
  return geom::kernel::with_bodies(
      a, b, [&](const auto& A, const auto& B) { return geom::distance(A, X_WA, B, X_WB, options); });
}

std::string describe(const BodyShape& shape) {
  return with(shape, [](const auto& s) { return std::string(s.description()); });
}

namespace internal {
namespace {

/// |s| <= R, h >= r.
template <class Shape>
double lever(const Shape& shape) {
  const double R = shape.bounding_radius();
  const double r = shape.inscribed_radius();
  return std::sqrt(std::max(0.0, (R - r) * (R + r)));
}

/// |s|^2 - h^2 = n.A^4 n / n.A^2 n - n.A^2 n <= (a_max - a_min)^2 (Kantorovich).
double lever(const geom::Ellipsoid& shape) {
  return shape.bounding_radius() - shape.inscribed_radius();
}

}  // namespace

std::optional<geom::kernel::CoreView> core_of(const BodyShape& shape) {
  return with(shape, [](const auto& s) -> std::optional<geom::kernel::CoreView> {
    if constexpr (requires { s.core(); }) return s.core();
    return std::nullopt;
  });
}

ConvexBody::ConvexBody(const BodyShape& body)
    : shape(body),
      core(core_of(shape)),
      smooth(std::holds_alternative<geom::Ellipsoid>(shape) || std::holds_alternative<geom::Superellipsoid>(shape)),
      own_distance(false),
      bounding_radius(ed::bounding_radius(shape)),
      lever(turning_lever(shape)),
      ball(core ? core->radius : with(shape, [](const auto& s) { return s.min_curvature_radius(); })),
      core_reach(core ? core->bounding_radius : bounding_radius - ball),
      core_inner(std::max(0.0, inscribed_radius(shape) - ball)) {
  const auto* custom = std::get_if<CustomShape>(&shape);
  own_distance = custom != nullptr && custom->pair_distance();
}

double turning_lever(const geom::Ellipsoid& shape) {
  return lever(shape);
}

double turning_lever(const geom::Shape& shape) {
  return geom::kernel::with_body(shape, [](const auto& s) { return lever(s); });
}

double turning_lever(const BodyShape& shape) {
  return geom::kernel::with_body(shape, [](const auto& s) { return lever(s); });
}

void check_exponents(const BodyShape& shape) {
  const auto check = [](double e) {
    if (e >= kMinExponentInMotion && e <= kMaxExponentInMotion) return;
    std::ostringstream message;
    message << "exponent is " << e << "; accepted of bodies in motion: " << kMinExponentInMotion << " to "
            << kMaxExponentInMotion;
    throw std::invalid_argument(message.str());
  };
  with(shape, [&](const auto& s) {
    if constexpr (requires { s.e1(); }) {
      check(s.e1());
      check(s.e2());
    }
  });
}

std::optional<geom::Shape> shape_with_equations(const BodyShape& shape) {
  std::optional<geom::Shape> found = with(shape, [](const auto& s) -> std::optional<geom::Shape> {
    if constexpr (std::constructible_from<geom::Shape, decltype(s)>) return s;
    return std::nullopt;
  });
  return found && geom::has_equations(*found) ? found : std::nullopt;
}

void check_finder(const ContactOptions& options, const BodyShape& shape) {
  if (options.finder == Finder::certified || shape_with_equations(shape)) return;
  const bool own = std::holds_alternative<CustomShape>(shape);
  throw std::invalid_argument("finder \"bracketing\" solves equations of smooth implicit surfaces, and shape " +
                              describe(shape) + (own ? " is a support function" : " has none") +
                              "; accepted: \"certified\"");
}

std::optional<NormBodyShape> norm_body(const BodyShape& shape) {
  return with(shape, [](const auto& s) -> std::optional<NormBodyShape> {
    if constexpr (std::constructible_from<geom::kernel::NormShape, decltype(s)>) {
      return NormBodyShape{geom::kernel::NormShape(s), s.bounding_radius(), s.inscribed_radius(), lever(s),
                           s.has_vertices()};
    }
    return std::nullopt;
  });
}

}  // namespace internal

}  // namespace ed
