#include <geom/any_shape.h>

namespace geom {

using Eigen::Vector3d;

DistanceResult distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  return std::visit([&](const auto& s, const auto& t) { return distance(s, X_WA, t, X_WB, options); }, a, b);
}

Support support(const Shape& shape, const Vector3d& n) {
  return std::visit([&](const auto& s) { return s.support(n); }, shape);
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
  return std::visit([&](const auto& s) { return oriented_box(s, X_WB); }, shape);
}

DistanceResult newton_distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, NewtonSystem system,
                               const WitnessPair& seed, const NewtonOptions& options) {
  return std::visit(
      [&](const auto& s, const auto& t) { return newton_distance(s, X_WA, t, X_WB, system, seed, options); }, a, b);
}

WitnessPair dual_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return std::visit([&](const auto& s, const auto& t) { return dual_seed(s, X_WA, t, X_WB); }, a, b);
}

WitnessPair centre_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return std::visit([&](const auto& s, const auto& t) { return centre_seed(s, X_WA, t, X_WB); }, a, b);
}

}  // namespace geom
