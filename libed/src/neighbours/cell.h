#pragma once

/// The paper's plain algorithm: a body's region is its cell of a regular grid, its neighbours are all bodies in that
/// and the 26 adjacent cells, and leaving it is a cell crossing (step 5 of the paper's list).

#include "base/archive.h"
#include "base/periodic.h"
#include "bodies/pair.h"
#include "neighbours/envelopes.h"
#include "neighbours/limits.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace ed::internal {

template <class Bodies>
class CellEnvelopes final : public Envelopes<Bodies>, public CellLayout {
 public:
  CellEnvelopes(int number, double box, double bounding_radius)
      : box_(box), cells_(cells_along(box, bounding_radius)), cell_(static_cast<std::size_t>(number)) {}

  double thickness() const override { return 0; }
  double reach() const override { return 2 * std::sqrt(3.0) * width() * (1 + 2 * kOvershoot); }
  void scale(double factor) override { box_ *= factor; }

  void place(int i, const Bodies& bodies, double now) override { place(i, bodies.position_at(i, now)); }
  void place(int i, const Eigen::Vector3d& position) {
    Eigen::Vector3i& cell = cell_[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) {
      const double fraction = position[k] / box_ - std::floor(position[k] / box_);
      cell[k] = static_cast<int>(fraction * cells_) % cells_;
    }
  }

  /// Returns the time when the centre has crossed a face of the cell, so far beyond it that rounding cannot put it
  /// back.
  double exit_time(int i, const Bodies& bodies, double now, double box) const override {
    return exit_time(i, bodies.position_at(i, now), bodies.velocity(i), now, box);
  }
  double exit_time(int i, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity, double now,
                   double box) const {
    const Eigen::Vector3i& cell = cell_[static_cast<std::size_t>(i)];
    const double half = (0.5 + kOvershoot) * width();
    double earliest = kNever;
    for (int k = 0; k < 3; ++k) {
      const double middle = (cell[k] + 0.5) * width();
      const double offset = position[k] - middle;
      const double x = offset - box * nearest_integer(offset / box);
      const double v = velocity[k];
      if (v != 0) earliest = std::min(earliest, now + ((v > 0 ? half : -half) - x) / v);
    }
    return std::max(now, earliest);
  }

  double worthwhile(int i, const Bodies& bodies) const override { return worthwhile(bodies.velocity(i)); }
  double worthwhile(const Eigen::Vector3d& velocity) const { return kOvershoot * width() / (velocity.norm() + 1e-300); }

  bool may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const override {
    if (offset(i, k).cwiseAbs().maxCoeff() > 1) return false;
    const Eigen::Vector3d d = image(i, k, r, box_);
    normal = d.squaredNorm() > 0 ? Eigen::Vector3d(d.normalized()) : Eigen::Vector3d::UnitX();
    return true;
  }

  /// Returns the vector between bodies of adjacent cells, in the image that the cells mean; `d` is its value in any
  /// image. The nearest image may be another one, where there are only three or four cells along an edge.
  Eigen::Vector3d image(int i, int k, const Eigen::Vector3d& d, double /*box*/) const override {
    const Eigen::Vector3d middle = width() * offset(i, k).template cast<double>();
    return middle + nearest_image(d - middle, box_);
  }

  void save(Writer& writer) const override { fields(writer, *this); }
  void load(Reader& reader) override { fields(reader, *this); }

 private:
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t number = self.cell_.size();
    archive(self.box_, self.cells_, self.cell_);
    const auto inside = [&](const Eigen::Vector3i& c) { return c.minCoeff() >= 0 && c.maxCoeff() < self.cells_; };
    expect(archive, self.cell_.size() == number && std::all_of(self.cell_.begin(), self.cell_.end(), inside),
           "the cells of the bodies");
  }

  double width() const { return box_ / cells_; }

  /// Returns the vector from the cell of i to that of k, the short way round.
  Eigen::Vector3i offset(int i, int k) const {
    Eigen::Vector3i d = cell_[static_cast<std::size_t>(k)] - cell_[static_cast<std::size_t>(i)];
    for (int c = 0; c < 3; ++c) {
      if (2 * d[c] > cells_) d[c] -= cells_;
      if (2 * d[c] < -cells_) d[c] += cells_;
    }
    return d;
  }

  double box_;
  int cells_;  ///< number along an edge
  std::vector<Eigen::Vector3i> cell_;
};

}  // namespace ed::internal
