#include "patch/polygon.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace geom::patch {
namespace {

/// Appends a corner; of two closer than the slack, the later one says what the side is.
void append_corner(Polygon& polygon, const Corner& corner, double slack) {
  if (!polygon.empty() && (polygon.back().place - corner.place).norm() <= slack) {
    const Corner& last = polygon.back();
    polygon.back() = {last.place, corner.side, last.is_done && corner.is_done, std::max(last.outside, corner.outside)};
  } else {
    polygon.push_back(corner);
  }
}

/// Leaves out the last corners if they are no further from the first one than the slack.
void close(Polygon& polygon, double slack) {
  while (polygon.size() > 1 && (polygon.back().place - polygon.front().place).norm() <= slack) polygon.pop_back();
}

}  // namespace

bool cut(Polygon& polygon, const Vector2d& normal, double reach, std::uint64_t side, double slack) {
  Polygon kept;
  kept.reserve(polygon.size() + 2);
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Corner& here = polygon[k];
    const Corner& next = polygon[(k + 1) % polygon.size()];
    const double d = normal.dot(here.place) - reach, e = normal.dot(next.place) - reach;
    if (d <= slack) append_corner(kept, here, slack);
    if ((d <= slack) == (e <= slack)) continue;
    // Where the edge crosses the line; corners within the slack stay where they are.
    const Vector2d crossing = here.place + std::clamp(d / (d - e), 0.0, 1.0) * (next.place - here.place);
    append_corner(kept, {crossing, d <= slack ? side : here.side, false}, slack);
  }
  close(kept, slack);
  polygon = std::move(kept);
  return !polygon.empty();
}

std::size_t merge(Polygon& polygon, double shortest) {
  Polygon kept;
  for (const Corner& corner : polygon) append_corner(kept, corner, shortest);
  close(kept, shortest);
  polygon = std::move(kept);
  return polygon.size();
}

double area(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    sum += cross(polygon[k - 1].place - polygon[0].place, polygon[k].place - polygon[0].place) / 2;
  }
  return sum;
}

Vector2d centroid(const Polygon& polygon) {
  Vector2d sum = Vector2d::Zero(), mean = Vector2d::Zero();
  double total = 0;
  for (const Corner& corner : polygon) mean += corner.place / static_cast<double>(polygon.size());
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vector2d u = polygon[k - 1].place - polygon[0].place, v = polygon[k].place - polygon[0].place;
    const double triangle = cross(u, v);
    total += triangle;
    sum += triangle / 3 * (u + v);
  }
  const Vector2d centre = polygon[0].place + sum / total;
  return total > 0 && centre.allFinite() ? centre : mean;
}

std::pair<std::size_t, std::size_t> longest(const Polygon& polygon) {
  std::pair<std::size_t, std::size_t> best{0, 0};
  double most = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    for (std::size_t j = i + 1; j < polygon.size(); ++j) {
      const double length = (polygon[j].place - polygon[i].place).squaredNorm();
      if (length > most) {
        most = length;
        best = {i, j};
      }
    }
  }
  return best;
}

double width_across(const Polygon& polygon, const Vector2d& along) {
  const Vector2d across(-along.y(), along.x());
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Corner& corner : polygon) {
    least = std::min(least, across.dot(corner.place));
    most = std::max(most, across.dot(corner.place));
  }
  return most - least;
}

void reduce(Polygon& polygon, std::size_t most) {
  while (polygon.size() > most) {
    const std::size_t n = polygon.size();
    std::size_t smallest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < n; ++k) {
      const Vector2d before = polygon[(k + n - 1) % n].place, after = polygon[(k + 1) % n].place;
      const double triangle = cross(polygon[k].place - before, after - before);
      if (triangle < least) {
        least = triangle;
        smallest = k;
      }
    }
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(smallest));
  }
}

}  // namespace geom::patch
