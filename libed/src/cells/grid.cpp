#include "cells/grid.h"

#include "base/prefetch.h"
#include "cells/choose.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace ed::internal {
namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

/// Width, in cells, by which distances of cells are underestimated: more than the rounding of a position up to 10^7
/// boxes away.
constexpr double kMargin = 1e-6;

/// Returns the maximum number of cells along an edge: no more cells than bodies (to within a factor), because finer
/// ones would be empty.
double most_cells(std::size_t number) {
  return 1.3 * std::cbrt(static_cast<double>(number));
}

}  // namespace

CellGrid::CellGrid(int number, double box, double reach, const std::optional<geom::InstructionSet>& batches, int placed)
    : placed_(at(placed)),
      box_(box),
      reach_(reach),
      cells_(choose_cells(placed, box, reach)),
      kernel_(find_cell_kernel(batches)),
      cell_of_body_(at(number), kNone) {
  clear();
}

void CellGrid::use(geom::InstructionSet set) {
  kernel_ = find_cell_kernel(set);
}

/// Returns the number along an edge for which the fewest blocks are tested.
int CellGrid::choose_cells(int number, double box, double reach) {
  const double most = std::min(most_cells(at(number)), kNarrowest * box / reach);
  int best = 1;
  double least = std::numeric_limits<double>::infinity();
  for (int cells = 1; cells <= std::max(1, static_cast<int>(most)); ++cells) {
    const double all = static_cast<double>(cells) * cells * cells;
    // Volume of a sphere of this radius: the reach plus half a cell and a little more.
    const double radius = reach * cells / box + 0.55;
    const double touched = std::min(all, 4 * std::numbers::pi / 3 * radius * radius * radius);
    // Blocks after a cell's own block have to be waited for.
    const double blocks = 1 + 1.5 * std::max(0.0, number / all - 2) / kCellBlock;
    if (touched * blocks < least) {
      least = touched * blocks;
      best = cells;
    }
  }
  return best;
}

/// Removes all bodies, and reserves memory for all of them wherever they are.
void CellGrid::clear() {
  const std::size_t own = at(cells_) * at(cells_) * at(cells_);
  const std::size_t full = placed_ / kCellBlock;
  blocks_.clear();
  next_.clear();
  free_.clear();
  blocks_.reserve(own + full);
  next_.reserve(own + full);
  free_.reserve(full);
  blocks_.resize(own);
  next_.resize(own, kNone);
  count_.assign(own, 0);
  std::fill(cell_of_body_.begin(), cell_of_body_.end(), kNone);
}

/// Returns a coordinate in widths of a cell, from 0 to cells_.
double CellGrid::coordinate(double x) const {
  const double boxes = x / box_;
  return (boxes - std::floor(boxes)) * cells_;
}

int CellGrid::cell_at(double coordinate) const {
  return std::min(cells_ - 1, static_cast<int>(coordinate));
}

int CellGrid::cell_of(const Eigen::Vector3d& p) const {
  const auto cell = [this](double x) { return cell_at(coordinate(x)); };
  return (cell(p.x()) * cells_ + cell(p.y())) * cells_ + cell(p.z());
}

// ---- Bodies --------------------------------------------------------------------------------------------------------

CellGrid::BlockLane CellGrid::find(int i) const {
  for (int block = cell_of_body_[at(i)];; block = next_[at(block)]) {
    for (int lane = 0; lane < kCellBlock; ++lane) {
      if (blocks_[at(block)].name[lane].body == i) return {block, lane};
    }
    assert(next_[at(block)] != kNone);
  }
}

void CellGrid::put(BlockLane where, int i, const Eigen::Vector3d& position) {
  CellBlock& block = blocks_[at(where.block)];
  block.x[where.lane] = position.x();
  block.y[where.lane] = position.y();
  block.z[where.lane] = position.z();
  block.name[where.lane].body = i;
}

void CellGrid::insert(int i, int cell, const Eigen::Vector3d& position) {
  int& count = count_[at(cell)];
  const int lane = count % kCellBlock;
  if (lane == 0 && count > 0) {
    int full = 0;
    if (free_.empty()) {
      full = static_cast<int>(blocks_.size());
      blocks_.emplace_back();
      next_.push_back(kNone);
    } else {
      full = free_.back();
      free_.pop_back();
    }
    blocks_[at(full)] = blocks_[at(cell)];
    next_[at(full)] = next_[at(cell)];
    blocks_[at(cell)] = CellBlock();
    next_[at(cell)] = full;
  }
  put({cell, lane}, i, position);
  ++count;
  cell_of_body_[at(i)] = cell;
}

void CellGrid::remove(int i) {
  const int cell = cell_of_body_[at(i)];
  int& count = count_[at(cell)];
  const BlockLane hole = find(i);
  CellBlock& own = blocks_[at(cell)];
  const int last = (count - 1) % kCellBlock;
  put(hole, own.name[last].body, {own.x[last], own.y[last], own.z[last]});
  own.clear(last);
  --count;
  cell_of_body_[at(i)] = kNone;
  const int full = next_[at(cell)];
  if (last > 0 || full == kNone) return;
  own = blocks_[at(full)];
  next_[at(cell)] = next_[at(full)];
  free_.push_back(full);
}

void CellGrid::place(int i, const Eigen::Vector3d& position) {
  const int cell = cell_of(position);
  const int old = cell_of_body_[at(i)];
  if (cell == old) {
    put(find(i), i, position);
    return;
  }
  if (old != kNone) remove(i);
  insert(i, cell, position);
}

bool CellGrid::cover(double reach) const {
  return cells_ == 1 || cells_ <= kNarrowest * box_ / reach * (1 + 1e-9);
}

void CellGrid::scale(double factor) {
  box_ *= factor;
  reach_ *= factor;
  for (CellBlock& block : blocks_) {
    for (int lane = 0; lane < kCellBlock; ++lane) {
      block.x[lane] *= factor;
      block.y[lane] *= factor;
      block.z[lane] *= factor;
    }
  }
}

// ---- Search

CellGrid::Along CellGrid::along(double coordinate, double widths) const {
  assert(widths <= kNarrowest + 2 * kMargin || 2 * widths >= cells_);
  Along result;
  const bool all = 2 * widths >= cells_;
  const int first = all ? 0 : static_cast<int>(coordinate - widths + cells_) - cells_;
  const int last = all ? 0 : static_cast<int>(coordinate + widths);
  // Every cell is tested once, without distinguishing between its images on either side.
  if (all || last - first + 1 > cells_) {
    result.count = cells_;
    for (int k = 0; k < cells_; ++k) {
      result.cell[at(k)] = k;
      result.distance2[at(k)] = 0;
    }
    return result;
  }
  for (int k = first; k <= last; ++k) {
    const double distance = std::max({0.0, k - coordinate, coordinate - (k + 1)});
    result.cell[at(result.count)] = wrapped(k);
    result.distance2[at(result.count)] = distance * distance;
    ++result.count;
  }
  return result;
}

template <class Found>
void CellGrid::for_each_cell_near(const Eigen::Vector3d& position, double reach, Found&& found) const {
  const double widths = reach * cells_ / box_ + kMargin;
  const Along x = along(coordinate(position.x()), widths);
  const Along y = along(coordinate(position.y()), widths);
  const Along z = along(coordinate(position.z()), widths);
  const double most = widths * widths;
  for (int i = 0; i < x.count; ++i) {
    for (int j = 0; j < y.count; ++j) {
      const double left = most - x.distance2[at(i)] - y.distance2[at(j)];
      if (left < 0) continue;
      const int row = (x.cell[at(i)] * cells_ + y.cell[at(j)]) * cells_;
      for (int k = 0; k < z.count; ++k) found(row + z.cell[at(k)], z.distance2[at(k)] <= left);
    }
  }
}

void CellGrid::fetch(const Eigen::Vector3d& position, double reach) const {
  for_each_cell_near(position, reach, [this](int cell, bool counts) {
    if (counts) prefetch(blocks_[at(cell)]);
  });
}

std::span<const NearBody> CellGrid::collect(const Eigen::Vector3d& position, double reach,
                                            std::vector<NearBody>& buffer) const {
  // The cells' own blocks, then one block after each of those that have more, and so on: reads within a round do not
  // wait for each other.
  std::array<int, kMostAlong * kMostAlong * kMostAlong> round;
  std::size_t open = 0;
  for_each_cell_near(position, reach, [&](int cell, bool counts) {
    // Always written and kept if it counts: whether it does is not predictable.
    round[open] = cell;
    open += counts ? 1 : 0;
  });
  const CellQuery query{position.x(), position.y(), position.z(), box_, reach * reach};
  std::size_t found = 0;
  while (open > 0) {
    const std::size_t room = found + kCellBlock * open;
    if (buffer.size() < room) buffer.resize(2 * room);
    auto* const near = reinterpret_cast<double*>(buffer.data() + found);
    found += static_cast<std::size_t>(kernel_(query, blocks_.data(), round.data(), static_cast<int>(open), near));
    std::size_t left = 0;
    for (std::size_t k = 0; k < open; ++k) {
      const int next = next_[at(round[k])];
      round[left] = next;
      left += next != kNone ? 1 : 0;
    }
    open = left;
  }
  return {buffer.data(), found};
}

// ---- State ---------------------------------------------------------------------------------------------------------

CellGrid::Content CellGrid::content() const {
  Content result{box_, cells_, {count_.begin(), count_.end()}, {}, {}};
  result.bodies.reserve(placed_);
  result.positions.reserve(placed_);
  std::vector<int> chain;
  for (std::size_t cell = 0; cell < count_.size(); ++cell) {
    chain.clear();
    for (int block = static_cast<int>(cell); block != kNone; block = next_[at(block)]) chain.push_back(block);
    for (auto block = chain.rbegin(); block != chain.rend(); ++block) {
      const CellBlock& b = blocks_[at(*block)];
      for (int lane = 0; lane < kCellBlock && b.name[lane].body != kNone; ++lane) {
        result.bodies.push_back(b.name[lane].body);
        result.positions.emplace_back(b.x[lane], b.y[lane], b.z[lane]);
      }
    }
  }
  return result;
}

/// Returns false if there is no such grid of these bodies in this box.
bool CellGrid::assign(const Content& content) {
  const std::size_t number = cell_of_body_.size();
  if (content.box != box_) return false;
  if (content.cells < 1 || (content.cells > 1 && content.cells > most_cells(placed_))) return false;
  if (content.bodies.size() != placed_ || content.positions.size() != placed_) return false;
  cells_ = content.cells;
  if (!cover(reach_)) return false;
  clear();
  if (content.count.size() != count_.size()) return false;
  std::size_t next = 0;
  for (std::size_t cell = 0; cell < content.count.size(); ++cell) {
    if (content.count[cell] < 0) return false;
    for (int k = 0; k < content.count[cell]; ++k, ++next) {
      if (next == placed_) return false;
      const int body = content.bodies[next];
      const bool fits = body >= 0 && at(body) < number && cell_of_body_[at(body)] == kNone;
      if (!fits || !content.positions[next].allFinite()) return false;
      insert(body, static_cast<int>(cell), content.positions[next]);
    }
  }
  return next == placed_;
}

}  // namespace ed::internal
