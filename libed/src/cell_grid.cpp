#include "cell_grid.h"

#include "periodic.h"

#include <algorithm>
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
      cell_of_body_(static_cast<std::size_t>(number), -1) {
  bodies_.resize(static_cast<std::size_t>(cells_) * cells_ * cells_);
  // Room for what a cell holds at times, so that moving bodies about does not allocate.
  for (std::vector<Entry>& cell : bodies_) cell.reserve(8 + 2 * static_cast<std::size_t>(number) / bodies_.size());
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
}

int CellGrid::coordinate(double x) const {
  const double fraction = x / box_ - std::floor(x / box_);
  return std::min(cells_ - 1, static_cast<int>(fraction * cells_));
}

int CellGrid::cell_of(const Eigen::Vector3d& p) const {
  return (coordinate(p.x()) * cells_ + coordinate(p.y())) * cells_ + coordinate(p.z());
}

void CellGrid::place(int i, const Eigen::Vector3d& position) {
  const int cell = cell_of(position);
  int& current = cell_of_body_[static_cast<std::size_t>(i)];
  if (current >= 0) {
    std::vector<Entry>& old = bodies_[static_cast<std::size_t>(current)];
    const auto entry = std::find_if(old.begin(), old.end(), [i](const Entry& e) { return e.body == i; });
    *entry = old.back();
    old.pop_back();
  }
  bodies_[static_cast<std::size_t>(cell)].push_back({position, i});
  current = cell;
}

void CellGrid::scale(double factor) {
  box_ *= factor;
  for (std::vector<Entry>& cell : bodies_) {
    for (Entry& entry : cell) entry.position *= factor;
  }
}

std::span<const NearBody> CellGrid::collect(const Eigen::Vector3d& position, double reach,
                                            std::vector<NearBody>& buffer) const {
  const int cx = coordinate(position.x());
  const int cy = coordinate(position.y());
  const int cz = coordinate(position.z());
  const auto wrap = [this](int k) { return k < 0 ? k + cells_ : (k >= cells_ ? k - cells_ : k); };
  const double reach2 = reach * reach;
  std::size_t found = 0;
  for (const Eigen::Vector3i& offset : stencil_) {
    const int cell = (wrap(cx + offset.x()) * cells_ + wrap(cy + offset.y())) * cells_ + wrap(cz + offset.z());
    const std::vector<Entry>& entries = bodies_[static_cast<std::size_t>(cell)];
    if (buffer.size() < found + entries.size()) buffer.resize(2 * (found + entries.size()));
    for (const Entry& entry : entries) {
      // Written always and kept if it counts: whether it does is not predictable, and a branch would cost more.
      NearBody& near = buffer[found];
      near.body = entry.body;
      near.r = nearest_image(entry.position - position, box_);
      found += near.r.squaredNorm() <= reach2 ? 1 : 0;
    }
  }
  return {buffer.data(), found};
}

}  // namespace ed::internal
