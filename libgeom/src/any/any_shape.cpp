#include <geom/any_shape.h>
#include <geom/kernel/any_body.h>

namespace geom {

using Eigen::Vector3d;

DistanceResult distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  return kernel::with_bodies(a, b, [&](const auto& s, const auto& t) { return distance(s, X_WA, t, X_WB, options); });
}

Support support(const Shape& shape, const Vector3d& n) {
  return kernel::with_body(shape, [&](const auto& s) { return s.support(n); });
}

double bounding_radius(const Shape& shape) {
  return std::visit([](const auto& s) { return s.bounding_radius(); }, shape);
}

double inscribed_radius(const Shape& shape) {
  return std::visit([](const auto& s) { return s.inscribed_radius(); }, shape);
}

double volume(const Shape& shape) {
  return std::visit([](const auto& s) { return s.volume(); }, shape);
}

Vector3d inertia(const Shape& shape, double mass) {
  return std::visit([&](const auto& s) { return s.inertia(mass); }, shape);
}

OrientedBox oriented_box(const Shape& shape, const Pose& X_WB) {
  return kernel::with_body(shape, [&](const auto& s) { return oriented_box(s, X_WB); });
}

MassProperties mass_properties(const Shape& shape) {
  constexpr double kClosedForm = 1e-12;  // the volume of superellipsoids
  const auto of = [](const auto& s) -> MassProperties {
    if constexpr (requires { s.core(); }) {
      const kernel::SweptMass mass = kernel::swept_mass(s.core());
      return {mass.volume, mass.first_moment, mass.inertia(mass.volume), kClosedForm};
    } else {
      const double volume = s.volume();
      return {volume, Vector3d::Zero(), s.inertia(volume).asDiagonal(), kClosedForm};
    }
  };
  return kernel::with_body(shape, of);
}

std::string description(const Shape& shape) {
  return std::visit([](const auto& s) { return s.description(); }, shape);
}

bool has_equations(const Shape& shape) {
  return std::holds_alternative<Ellipsoid>(shape) || std::holds_alternative<Superellipsoid>(shape) ||
         std::holds_alternative<Sphere>(shape);
}

void kernel::refuse_equations(const std::string& what, const Shape& shape) {
  refuse(what + ": the paper's equations need surfaces with second derivatives, and the shape is a " +
         description(shape) + "; accepted: ellipsoids, superellipsoids and spheres");
}

namespace {

/// Returns f(surface_a, surface_b) of two shapes that have equations.
template <class F>
auto with_surfaces(const char* what, const Shape& a, const Shape& b, const F& f) {
  return kernel::with_equations(
      what, a, [&](const auto& s) { return kernel::with_equations(what, b, [&](const auto& t) { return f(s, t); }); });
}

}  // namespace

DistanceResult newton_distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, NewtonSystem system,
                               const WitnessPair& seed, const NewtonOptions& options) {
  return with_surfaces("newton_distance", a, b, [&](const auto& s, const auto& t) {
    return newton_distance(s, X_WA, t, X_WB, system, seed, options);
  });
}

DistanceResult kernel::newton_distance_unchecked(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                                 NewtonSystem system, const WitnessPair& seed,
                                                 const NewtonOptions& options) {
  return with_surfaces("newton_distance", a, b, [&](const auto& s, const auto& t) {
    return newton_distance_unchecked(s, X_WA, t, X_WB, system, seed, options);
  });
}

WitnessPair checked_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, const WitnessPair& seed) {
  return with_surfaces("checked_seed", a, b,
                       [&](const auto& s, const auto& t) { return checked_seed(s, X_WA, t, X_WB, seed); });
}

WitnessPair dual_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return kernel::with_bodies(a, b, [&](const auto& s, const auto& t) { return dual_seed(s, X_WA, t, X_WB); });
}

WitnessPair centre_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return with_surfaces("centre_seed", a, b,
                       [&](const auto& s, const auto& t) { return centre_seed(s, X_WA, t, X_WB); });
}

}  // namespace geom
