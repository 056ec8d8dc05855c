#include "plot/contours.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace hardbody {
namespace {

/// Maximum number of rows between the ends of adjacent columns for the gap between them to be filled.
constexpr std::size_t kHighestStep = 4;

using Node = std::size_t;               // index of a point of the lattice
using Edge = std::pair<Node, Node>;     // edge between two nodes, the smaller first
using Segment = std::pair<Edge, Edge>;  // part of a line in a cell: from one edge to another

std::vector<double> distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

std::size_t index_of(const std::vector<double>& values, double x) {
  return static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), x) - values.begin());
}

/// Interpolates between known values of a column.
void fill_column(Lattice& lattice, std::size_t i) {
  const std::size_t rows = lattice.y.size();
  std::optional<std::size_t> last;
  for (std::size_t j = 0; j < rows; ++j) {
    const std::optional<double> here = lattice.at(i, j);
    if (!here) continue;
    for (std::size_t k = last ? *last + 1 : j; k < j; ++k) {
      const double share = (lattice.y[k] - lattice.y[*last]) / (lattice.y[j] - lattice.y[*last]);
      const double before = *lattice.at(i, *last);
      lattice.values[i * rows + k] = before + share * (*here - before);
    }
    last = j;
  }
}

/// Marches through the cells of one lattice.
class Marcher {
 public:
  Marcher(const Lattice& lattice, double level) : lattice_(lattice), level_(level) {}

  std::vector<ContourLine> lines() {
    march();
    return joined();
  }

  bool has_cells() {
    march();
    return cells_ > 0;
  }

 private:
  void march() {
    for (std::size_t i = 0; i + 1 < lattice_.x.size(); ++i) {
      for (std::size_t j = 0; j + 1 < lattice_.y.size(); ++j) cross_cell(i, j);
    }
  }

  bool known(Node n) const { return lattice_.values[n].has_value(); }
  double value(Node n) const { return *lattice_.values[n]; }
  bool above(Node n) const { return value(n) >= level_; }
  Node node(std::size_t i, std::size_t j) const { return i * lattice_.y.size() + j; }
  double x(Node n) const { return lattice_.x[n / lattice_.y.size()]; }
  double y(Node n) const { return lattice_.y[n % lattice_.y.size()]; }

  static Edge edge(Node a, Node b) { return a < b ? Edge{a, b} : Edge{b, a}; }

  /// Returns the edges between successive corners that the level crosses.
  template <std::size_t n>
  std::vector<Edge> crossed(const std::array<Node, n>& corners) const {
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < n; ++k) {
      const Node a = corners[k];
      const Node b = corners[(k + 1) % n];
      if (above(a) != above(b)) edges.push_back(edge(a, b));
    }
    return edges;
  }

  void cross_cell(std::size_t i, std::size_t j) {
    const std::array<Node, 4> corners = {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)};
    const auto missing = std::count_if(corners.begin(), corners.end(), [&](Node n) { return !known(n); });
    if (missing == 0) cross_square(corners);
    if (missing == 1) cross_corner(corners);
    if (missing != 2) return;
    // One of the columns ends below, or begins above.
    if (known(corners[1]) && known(corners[2])) cross_fan(i, j, corners[1], corners[2]);
    if (known(corners[0]) && known(corners[3])) cross_fan(i + 1, j, corners[0], corners[3]);
  }

  /// Returns the last known node of column i below row j, or the first one above row j + 1; nullopt if that is far.
  std::optional<Node> end_near(std::size_t i, std::size_t j) const {
    for (std::size_t step = 1; step < kHighestStep; ++step) {
      if (step <= j && known(node(i, j - step))) return node(i, j - step);
      if (j + 1 + step < lattice_.y.size() && known(node(i, j + 1 + step))) return node(i, j + 1 + step);
    }
    return std::nullopt;
  }

  /// Handles the triangle of the end of column i and an edge of the adjacent column, at row j.
  void cross_fan(std::size_t i, std::size_t j, Node low, Node high) {
    if (const std::optional<Node> end = end_near(i, j)) cross_triangle({*end, low, high});
  }

  void cross_corner(const std::array<Node, 4>& corners) {
    std::array<Node, 3> three{};
    std::copy_if(corners.begin(), corners.end(), three.begin(), [&](Node n) { return known(n); });
    cross_triangle(three);
  }

  void cross_triangle(const std::array<Node, 3>& three) {
    ++cells_;
    const std::vector<Edge> edges = crossed(three);
    if (edges.size() == 2) segments_.emplace_back(edges[0], edges[1]);
  }

  void cross_square(const std::array<Node, 4>& corners) {
    ++cells_;
    const std::vector<Edge> edges = crossed(corners);
    if (edges.size() == 2) segments_.emplace_back(edges[0], edges[1]);
    if (edges.size() != 4) return;
    // A saddle: corners on the same side of the level as the centre are connected. Edge k leads from corner k to k + 1.
    double mean = 0;
    for (const Node n : corners) mean += value(n) / 4;
    const bool around_first = (mean >= level_) != above(corners[0]);
    segments_.emplace_back(edges[0], around_first ? edges[3] : edges[1]);
    segments_.emplace_back(edges[2], around_first ? edges[1] : edges[3]);
  }

  PlanePoint crossing(const Edge& e) const {
    const auto [a, b] = e;
    const double share = (level_ - value(a)) / (value(b) - value(a));
    return {x(a) + share * (x(b) - x(a)), y(a) + share * (y(b) - y(a))};
  }

  /// Follows the segments from `begin` on, to the end of the line.
  ContourLine walk(Edge at, std::multimap<Edge, std::size_t>& of_edge) {
    ContourLine line = {crossing(at)};
    for (auto found = of_edge.find(at); found != of_edge.end(); found = of_edge.find(at)) {
      const Segment segment = segments_[found->second];
      const Edge next = segment.first == at ? segment.second : segment.first;
      remove(of_edge, found->second);
      at = next;
      line.push_back(crossing(at));
    }
    return line;
  }

  void remove(std::multimap<Edge, std::size_t>& of_edge, std::size_t segment) const {
    for (const Edge& e : {segments_[segment].first, segments_[segment].second}) {
      const auto [from, to] = of_edge.equal_range(e);
      for (auto it = from; it != to; ++it) {
        if (it->second != segment) continue;
        of_edge.erase(it);
        break;
      }
    }
  }

  std::vector<ContourLine> joined() {
    std::multimap<Edge, std::size_t> of_edge;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      of_edge.emplace(segments_[k].first, k);
      of_edge.emplace(segments_[k].second, k);
    }
    std::vector<ContourLine> lines;
    // Open lines begin at an edge that only one segment reaches; the remaining ones are closed.
    for (const bool open : {true, false}) {
      for (const Segment& segment : segments_) {
        for (const Edge& e : {segment.first, segment.second}) {
          const std::size_t reached = of_edge.count(e);
          if (reached == 0 || (open && reached != 1)) continue;
          lines.push_back(walk(e, of_edge));
        }
      }
    }
    std::stable_sort(lines.begin(), lines.end(),
                     [](const ContourLine& a, const ContourLine& b) { return a.size() > b.size(); });
    return lines;
  }

  const Lattice& lattice_;
  double level_;
  std::vector<Segment> segments_;
  std::size_t cells_ = 0;
};

}  // namespace

Lattice lattice_of(const std::vector<Sample>& samples) {
  Lattice lattice;
  for (const Sample& s : samples) {
    lattice.x.push_back(s.x);
    lattice.y.push_back(s.y);
  }
  lattice.x = distinct(std::move(lattice.x));
  lattice.y = distinct(std::move(lattice.y));
  const std::size_t size = lattice.x.size() * lattice.y.size();
  std::vector<double> sums(size, 0.0);
  std::vector<int> counts(size, 0);
  for (const Sample& s : samples) {
    const std::size_t at = index_of(lattice.x, s.x) * lattice.y.size() + index_of(lattice.y, s.y);
    sums[at] += s.value;
    ++counts[at];
  }
  lattice.values.resize(size);
  for (std::size_t k = 0; k < size; ++k) {
    if (counts[k] > 0) lattice.values[k] = sums[k] / counts[k];
  }
  for (std::size_t i = 0; i < lattice.x.size(); ++i) fill_column(lattice, i);
  return lattice;
}

bool has_cells(const Lattice& lattice) {
  return Marcher(lattice, 0).has_cells();
}

std::vector<ContourLine> contour_lines(const Lattice& lattice, double level) {
  return Marcher(lattice, level).lines();
}

}  // namespace hardbody
