#include "patch/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

namespace geom::patch {
namespace {

/// Largest number of cuts: a safeguard, as each one leaves out a part of the plane for good.
constexpr int kMostCuts = 2000;
/// Uncertainty of the end of the patch on the way to a corner, of its distance from the corner.
constexpr double kGoodEnd = 0.2;
/// Largest number of steps to the end of the patch on a way.
constexpr int kMostSteps = 60;

/// Returns the distance of the two corners that are furthest apart; 0 of an empty polygon.
double diameter_of(const Polygon& polygon) {
  const auto [i, j] = longest(polygon);
  return polygon.empty() ? 0 : (polygon[j].place - polygon[i].place).norm();
}

std::uint64_t side_of(std::uint64_t kind, std::uint64_t feature_a, std::uint64_t feature_b) {
  return kind << 30 | (feature_a & 0x7fff) << 15 | (feature_b & 0x7fff);
}

}  // namespace

Polygon Outline::find() {
  Polygon polygon = box();
  double diameter = 0;
  for (int cuts = 0;;) {
    const auto open = std::find_if(polygon.begin(), polygon.end(), [](const Corner& c) { return !c.is_done; });
    if (open != polygon.end()) {
      if (cuts == kMostCuts) {
        error_ = diameter_of(polygon);
        break;
      }
      if (diameter == 0) diameter = diameter_of(polygon);
      if (!treat(polygon, static_cast<std::size_t>(open - polygon.begin()), diameter)) return {};
      ++cuts;
      continue;
    }
    // Corners were judged by the diameter that the polygon had then.
    const double now = diameter_of(polygon);
    if (is_exact_ || now > 0.9 * diameter || now <= rounding_) break;
    diameter = now;
    error_ = 0;
    for (Corner& corner : polygon) {
      corner.is_done = corner.outside <= options_.tolerance * now;
      if (corner.is_done) error_ = std::max(error_, corner.outside);
    }
  }
  return polygon;
}

std::optional<Outline::Heights> Outline::heights_at(const Vector2d& place) const {
  const std::optional<Tangent> s = is_exact_ ? a_.at(place) : a_.over(place);
  if (!s) return std::nullopt;
  const std::optional<Tangent> t = is_exact_ ? b_.at(place) : b_.over(place);
  if (!t) return std::nullopt;
  return Heights{place, s->height, t->height};
}

std::optional<Outline::Heights> Outline::heights(const Vector2d& x, const Vector2d& inner) const {
  for (const double share : {0.0, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0}) {
    if (std::optional<Heights> found = heights_at(x + share * (inner - x))) return found;
  }
  return inner_ ? heights_at(*inner_) : std::nullopt;
}

Polygon Outline::box() const {
  std::array<double, 4> reach{};  // along x, y, -x, -y
  const std::array<Vector2d, 4> along{Vector2d{1, 0}, Vector2d{0, 1}, Vector2d{-1, 0}, Vector2d{0, -1}};
  for (std::size_t k = 0; k < 4; ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (const Surface* surface : {&a_, &b_}) {
      if (surface->bounded()) least = std::min(least, surface->reach(along[k]));
    }
    reach[k] = least;
  }
  // A little larger, so that no side of it is one of the patch.
  const double margin = 0.01 * (std::abs(reach[0] + reach[2]) + std::abs(reach[1] + reach[3]));
  for (double& r : reach) r += margin;
  if (reach[0] < -reach[2] || reach[1] < -reach[3]) return {};
  return {{{-reach[2], -reach[3]}}, {{reach[0], -reach[3]}}, {{reach[0], reach[1]}}, {{-reach[2], reach[1]}}};
}

bool Outline::treat(Polygon& polygon, std::size_t k, double diameter) {
  const Vector2d x = polygon[k].place;
  const double tolerance = options_.tolerance * diameter;
  const Excess here = is_exact_ ? Excess{} : excess_at(x);
  // Rays that meet curved surfaces are quicker than the search for the edge of a shadow.
  if (is_exact_ || !std::isfinite(here.value)) {
    for (const Surface* surface : {&a_, &b_}) {
      const std::optional<Line> line = surface->beyond(x);
      if (!line) continue;
      const double excess = line->normal.dot(x) - line->reach;
      // The shadow may be twice as far away as the line.
      if (line->exact || excess > 0.5 * tolerance) {
        const std::uint64_t side = surface == &a_ ? side_of(1, line->feature, 0) : side_of(2, 0, line->feature);
        return cut(polygon, line->normal, line->reach, side, rounding_);
      }
    }
  }
  if (is_exact_ || !find_inner(polygon)) return treat_gap(polygon, k, diameter);
  return treat_smooth(polygon, k, tolerance, here);
}

Outline::Excess Outline::excess_at(const Vector2d& x) const {
  const std::optional<Tangent> s = a_.over(x);
  const std::optional<Tangent> t = s ? b_.over(x) : std::nullopt;
  if (!t) return {std::numeric_limits<double>::infinity(), Vector2d::Zero()};
  return {-(s->height + t->height) - options_.within, -(s->slope + t->slope)};
}

bool Outline::find_inner(const Polygon& polygon) {
  if (inner_) return true;
  for (const Vector2d& x : {Vector2d(Vector2d::Zero()), centroid(polygon)}) {
    const double excess = excess_at(x).value;
    if (excess > rounding_) continue;
    inner_ = x;
    inner_excess_ = std::min(excess, 0.0);
    return true;
  }
  return false;
}

/// Place of a corner on the way from a place of the patch (0) to it (1), between two bounds.
struct Outline::Ending {
  double low = 0, high = 1;
  Vector2d place = Vector2d::Zero();  ///< last place beyond the end
  Excess excess;                      ///< excess there
};

Outline::Ending Outline::ending(const Vector2d& x, const Excess& at_corner, double tolerance) const {
  const Vector2d way = x - *inner_;
  const double share = tolerance / way.norm();
  Ending end{0, 1, x, at_corner};
  double from = 0, excess_from = inner_excess_, beyond = 1;
  for (int step = 0; step < kMostSteps; ++step) {
    // A corner that is near needs no better end, one that is far away only a good one.
    if (1 - end.low <= share || end.high - end.low <= std::max(0.1 * share, kGoodEnd * (1 - end.high))) break;
    const double t = 0.5 * (end.low + end.high);
    const Vector2d place = *inner_ + t * way;
    const Excess excess = excess_at(place);
    if (excess.value <= 0) {
      from = end.low = t;
      excess_from = excess.value;
    } else {
      beyond = end.high = t;
      end.place = place;
      end.excess = excess;
    }
    if (!std::isfinite(end.excess.value)) continue;
    // The excess is convex: it is below its chord, and above its tangent.
    const double chord = from + (beyond - from) * excess_from / (excess_from - end.excess.value);
    const double rise = end.excess.slope.dot(way);
    end.low = std::max(end.low, chord);
    if (rise > 0) end.high = std::max(end.low, std::min(end.high, beyond - end.excess.value / rise));
  }
  return end;
}

bool Outline::treat_smooth(Polygon& polygon, std::size_t k, double tolerance, const Excess& at_corner) {
  const Vector2d x = polygon[k].place;
  polygon[k].is_done = true;
  if (at_corner.value <= rounding_) return true;
  const Ending end = ending(x, at_corner, tolerance);
  const double outside = (1 - end.low) * (x - *inner_).norm();
  if (outside > tolerance) {
    if (std::isfinite(end.excess.value)) {
      const Vector2d& gradient = end.excess.slope;
      const double steepness = gradient.norm();
      const double reach = gradient.dot(end.place) - end.excess.value;
      if (gradient.dot(x) > reach + rounding_ * steepness) {
        return cut(polygon, gradient / steepness, reach / steepness, 0, rounding_);
      }
    } else {
      const std::optional<Line> of_a = a_.beyond(end.place);
      const std::optional<Line> line = of_a ? of_a : b_.beyond(end.place);
      if (line && line->normal.dot(x) > line->reach + rounding_) {
        return cut(polygon, line->normal, line->reach, 0, rounding_);
      }
    }
  }
  polygon[k].outside = outside;
  error_ = std::max(error_, outside);
  return true;
}

bool Outline::treat_gap(Polygon& polygon, std::size_t k, double diameter) {
  const Vector2d x = polygon[k].place;
  const Vector2d inner = centroid(polygon);
  polygon[k].is_done = true;
  for (const double share : {0.0, 1e-9, 1e-6, 1e-4, 1e-2, 0.1}) {
    const Vector2d place = x + share * (inner - x);
    const std::optional<Tangent> s = a_.at(place), t = b_.at(place);
    if (!s || !t) continue;
    // Gaps are convex: tangent planes at any place are below them.
    const Vector2d gradient = -(s->slope + t->slope);
    const double excess = -(s->height + t->height) + gradient.dot(x - place) - options_.within;
    const double steepness = gradient.norm();
    if (excess <= rounding_ * (1 + steepness)) return true;
    if (steepness == 0) return false;
    const Vector2d normal = gradient / steepness;
    const std::uint64_t kind = s->feature != 0 && t->feature == 0 ? 1 : s->feature == 0 && t->feature != 0 ? 2 : 3;
    const double reach = normal.dot(x) - excess / steepness;
    return cut(polygon, normal, reach, side_of(kind, s->feature, t->feature), rounding_);
  }
  // Rays found no surface: how far the corner is from the patch is not known.
  polygon[k].outside = diameter;
  error_ = std::max(error_, diameter);
  return true;
}

}  // namespace geom::patch
