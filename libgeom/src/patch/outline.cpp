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

/// Largest number of cuts, and of those for each face and side of a polytope: a safeguard, as each one leaves out a
/// part of the plane for good.
constexpr std::size_t kMostCuts = 2000, kMostCutsOfEach = 8;
/// Uncertainty of the end of the patch on the way to a corner, of its distance from the corner.
constexpr double kGoodEnd = 0.2;
/// Largest number of times that corners are judged anew.
constexpr int kMostJudgements = 20;
/// Largest number of steps to the end of the patch on a way.
constexpr int kMostSteps = 60;
/// Largest number of lines that a place is moved to, one after the other.
constexpr int kMostRims = 32;

/// Returns the distance of the two corners that are furthest apart; 0 of an empty polygon.
double diameter_of(const Polygon& polygon) {
  const auto [i, j] = longest(polygon);
  return polygon.empty() ? 0 : (polygon[j].place - polygon[i].place).norm();
}

std::uint64_t side_of(std::uint64_t kind, std::uint64_t feature_a, std::uint64_t feature_b) {
  return kind << 62 | (feature_a & 0x7fffffff) << 31 | (feature_b & 0x7fffffff);
}

}  // namespace

Polygon Outline::find() {
  Polygon polygon = box();
  extent_ = diameter_of(polygon);
  const std::size_t most = kMostCuts + kMostCutsOfEach * (a_.features() + b_.features());
  double diameter = 0;
  int rounds = 0;
  for (std::size_t cuts = 0;;) {
    const auto open = std::find_if(polygon.begin(), polygon.end(), [](const Corner& c) { return !c.is_done; });
    if (open != polygon.end()) {
      if (cuts == most) {
        error_ = diameter_of(polygon);
        break;
      }
      if (diameter == 0) diameter = diameter_of(polygon);
      if (!treat(polygon, static_cast<std::size_t>(open - polygon.begin()), diameter)) return {};
      ++cuts;
      continue;
    }
    if (is_exact_) break;
    // Corners were judged by the diameter that the polygon had then.
    const double now = diameter_of(polygon);
    error_ = 0;
    for (const Corner& corner : polygon) error_ = std::max(error_, corner.outside);
    if (error_ <= options_.tolerance * now || now <= rounding_ || ++rounds == kMostJudgements) break;
    diameter = now;
    for (Corner& corner : polygon) corner.is_done = corner.outside <= options_.tolerance * now;
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

std::optional<Outline::Heights> Outline::heights_off_walls(const Vector2d& x, double most) const {
  Vector2d place = x;
  bool is_off = false;
  for (int step = 0; step < kMostRims && !is_off; ++step) {
    is_off = true;
    for (const Surface* surface : {&a_, &b_}) {
      const std::optional<Line> line = surface->past_rim(place);
      if (!line) continue;
      place -= (line->normal.dot(place) - line->reach) * line->normal;
      is_off = false;
    }
  }
  const double length = (place - x).norm();
  if (length > most) return heights_at(x + most / length * (place - x));
  // The height of a wall over its rim is uncertain; the other faces have the same there.
  const std::optional<Tangent> s = a_.top(place), t = b_.top(place);
  return is_off && s && t ? Heights{place, s->height, t->height} : heights_at(place);
}

void Outline::join_sides(Polygon& polygon, double slack) const {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector2d& next = polygon[(k + 1) % polygon.size()].place;
    const std::optional<std::uint32_t> side = a_.side_along(polygon[k].place, next, slack);
    if (side) polygon[k].side = side_of(1, *side, 0);
  }
  for (std::size_t k = polygon.size(); k-- > 0 && polygon.size() > 3;) {
    const Corner& before = polygon[(k + polygon.size() - 1) % polygon.size()];
    const Corner& after = polygon[(k + 1) % polygon.size()];
    const double off = (closest_on(before.place, after.place, polygon[k].place) - polygon[k].place).norm();
    if (before.side == polygon[k].side && off <= slack) polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(k));
  }
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
  // Rounding puts no place outside.
  const double excess = -(s->height + t->height) - options_.within;
  return {excess <= rounding_ ? std::min(excess, 0.0) : excess, -(s->slope + t->slope)};
}

bool Outline::find_inner(const Polygon& polygon) {
  if (inner_) return true;
  for (const Vector2d& x : {Vector2d(Vector2d::Zero()), centroid(polygon)}) {
    const double excess = excess_at(x).value;
    if (excess > 0) continue;
    inner_ = x;
    inner_excess_ = excess;
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

std::optional<Line> Outline::tangent_at(const Ending& end) const {
  if (std::isfinite(end.excess.value)) {
    const double steepness = end.excess.slope.norm();
    if (!(steepness > 0)) return std::nullopt;
    const Vector2d normal = end.excess.slope / steepness;
    return Line{normal, normal.dot(end.place) - end.excess.value / steepness, 0, false};
  }
  const std::optional<Line> of_a = a_.beyond(end.place);
  return of_a ? of_a : b_.beyond(end.place);
}

bool Outline::treat_smooth(Polygon& polygon, std::size_t k, double tolerance, const Excess& at_corner) {
  const Vector2d x = polygon[k].place;
  polygon[k].is_done = true;
  if (at_corner.value <= 0) return true;
  const Ending end = ending(x, at_corner, tolerance);
  polygon[k].outside = (1 - end.low) * (x - *inner_).norm();
  if (polygon[k].outside <= tolerance) return true;
  // Where two sides of the patch meet at a small angle, a corner that is near to both is far from where they meet: what
  // bounds the patch at the corner itself leaves it out.
  for (const Ending& at : {end, Ending{0, 1, x, at_corner}}) {
    const std::optional<Line> line = tangent_at(at);
    if (line && line->normal.dot(x) > line->reach + rounding_) {
      return cut(polygon, line->normal, line->reach, 0, rounding_);
    }
  }
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
