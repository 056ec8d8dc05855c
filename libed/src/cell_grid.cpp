#include "cell_grid.h"

#include "periodic.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace ed::internal {
namespace {

/// Offsets along one axis at which a cell can hold a body within `reach`, each cell of the period once.
std::vector<int> offsets(int cells, double width, double reach) {
  const int most = static_cast<int>(std::ceil(reach / width));
  std::vector<int> result;
  if (2 * most + 1 >= cells) {
    for (int k = 0; k < cells; ++k) result.push_back(k);
  } else {
    for (int k = -most; k <= most; ++k) result.push_back(k);
  }
  return result;
}

/// The least distance, along one axis, between points of two cells `offset` apart.
double least_gap(int offset, int cells, double width) {
  const int around = std::min(std::abs(offset), cells - std::abs(offset));
  return std::max(0, around - 1) * width;
}

}  // namespace

CellGrid::CellGrid(int number, double box, double reach)
    : box_(box),
      // No more cells than bodies (to within a factor): finer cells would be empty.
      cells_(std::clamp(static_cast<int>(2 * box / reach), 1,
                        std::max(1, static_cast<int>(1.3 * std::cbrt(static_cast<double>(number)))))),
      first_(static_cast<std::size_t>(cells_) * cells_ * cells_, kNone),
      bodies_(static_cast<std::size_t>(number)) {
  const double width = box / cells_;
  const std::vector<int> along = offsets(cells_, width, reach);
  for (const int x : along) {
    for (const int y : along) {
      for (const int z : along) {
        const Eigen::Vector3d gap(least_gap(x, cells_, width), least_gap(y, cells_, width),
                                  least_gap(z, cells_, width));
        if (gap.squaredNorm() < reach * reach) stencil_.emplace_back(x, y, z);
      }
    }
  }
  assert(stencil_.size() <= kMostOffsets);
}

int CellGrid::coordinate(double x) const {
  const double fraction = x / box_ - std::floor(x / box_);
  return std::min(cells_ - 1, static_cast<int>(fraction * cells_));
}

int CellGrid::cell_of(const Eigen::Vector3d& p) const {
  return (coordinate(p.x()) * cells_ + coordinate(p.y())) * cells_ + coordinate(p.z());
}

void CellGrid::place(int i, const Eigen::Vector3d& position) {
  Entry& body = bodies_[static_cast<std::size_t>(i)];
  body.position = position;
  const int cell = cell_of(position);
  if (cell == body.cell) return;
  if (body.cell != kNone) {
    int* link = &first_[static_cast<std::size_t>(body.cell)];
    while (*link != i) link = &bodies_[static_cast<std::size_t>(*link)].next;
    *link = body.next;
  }
  int& first = first_[static_cast<std::size_t>(cell)];
  body.cell = cell;
  body.next = first;
  first = i;
}

/// Every body is in its cell and nowhere else.
bool CellGrid::filled() const {
  if (!(box_ > 0) || !std::isfinite(box_) || cells_ < 1 || cells_ > 1000) return false;
  if (first_.size() != static_cast<std::size_t>(cells_) * cells_ * cells_) return false;
  std::vector<bool> found(bodies_.size(), false);
  for (std::size_t cell = 0; cell < first_.size(); ++cell) {
    for (int i = first_[cell]; i != kNone; i = bodies_[static_cast<std::size_t>(i)].next) {
      const auto body = static_cast<std::size_t>(i);
      if (i < 0 || body >= bodies_.size() || found[body]) return false;
      if (bodies_[body].cell != static_cast<int>(cell) || !bodies_[body].position.allFinite()) return false;
      found[body] = true;
    }
  }
  return stencil_.size() <= kMostOffsets && std::all_of(found.begin(), found.end(), [](bool is) { return is; }) &&
         std::all_of(stencil_.begin(), stencil_.end(), [this](const auto& offset) {
           return offset.minCoeff() >= -cells_ && offset.maxCoeff() <= cells_;
         });
}

void CellGrid::scale(double factor) {
  box_ *= factor;
  for (Entry& body : bodies_) body.position *= factor;
}

std::span<const NearBody> CellGrid::collect(const Eigen::Vector3d& position, double reach,
                                            std::vector<NearBody>& buffer) const {
  const int cx = coordinate(position.x());
  const int cy = coordinate(position.y());
  const int cz = coordinate(position.z());
  const auto wrap = [this](int k) { return k < 0 ? k + cells_ : (k >= cells_ ? k - cells_ : k); };
  const double reach2 = reach * reach;
  // One body of each cell, then the next of each that has more: what is read in a round does not wait for what was read
  // before it in the round, and how full cells are is not predictable.
  std::array<int, kMostOffsets> round;
  std::size_t open = 0;
  for (const Eigen::Vector3i& offset : stencil_) {
    const int cell = (wrap(cx + offset.x()) * cells_ + wrap(cy + offset.y())) * cells_ + wrap(cz + offset.z());
    const int body = first_[static_cast<std::size_t>(cell)];
    round[open] = body;
    open += body != kNone ? 1 : 0;
  }
  std::size_t found = 0;
  while (open > 0) {
    if (buffer.size() < found + open) buffer.resize(2 * found + open + 64);
    std::size_t left = 0;
    for (std::size_t k = 0; k < open; ++k) {
      const int i = round[k];
      const Entry& body = bodies_[static_cast<std::size_t>(i)];
      // Written always and kept if it counts: whether it does is not predictable either.
      NearBody& near = buffer[found];
      near.body = i;
      near.r = nearest_image(body.position - position, box_);
      found += near.r.squaredNorm() <= reach2 ? 1 : 0;
      round[left] = body.next;
      left += body.next != kNone ? 1 : 0;
    }
    open = left;
  }
  return {buffer.data(), found};
}

}  // namespace ed::internal
