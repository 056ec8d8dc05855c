#pragma once

/// The best of many answers.

#include "scene/bodies.h"
#include "scene/images.h"

#include <geom/scene.h>

#include <Eigen/Core>

#include <cmath>
#include <limits>
#include <optional>

namespace geom::scene {

/// The best answer so far, of answers that come in any order: the least value, then the smallest handle and image.
/// Declined answers win if their lower bound is not above the least value.
template <class Result>
class Best {
 public:
  explicit Best(double limit) : limit_(limit) {}

  void add(BodyId body, const Eigen::Vector3d& cell, double value, const Result& result) {
    if (!(value <= limit_)) return;
    if (found_ && value == limit_ && !before(body, cell, *found_)) return;
    found_ = Found{body, cell, result};
    limit_ = value;
  }
  void decline(BodyId body, const Eigen::Vector3d& cell, double bound, const Result& result) {
    if (std::isnan(bound)) bound = -std::numeric_limits<double>::infinity();
    if (declined_ && bound > declined_bound_) return;
    if (declined_ && bound == declined_bound_ && !before(body, cell, *declined_)) return;
    declined_ = Found{body, cell, result};
    declined_bound_ = bound;
  }

  double limit() const { return limit_; }

  struct Found {
    BodyId body;
    Eigen::Vector3d cell;
    Result result;
  };
  /// Returns the answer; null: none.
  const Found* answer() const {
    if (declined_ && declined_bound_ <= limit_) return &*declined_;
    return found_ ? &*found_ : nullptr;
  }
  /// Returns the answer's body; nullopt: no answer.
  std::optional<SceneImage> image(const Images& images) const {
    if (answer() == nullptr) return std::nullopt;
    return SceneImage{answer()->body, images.vector(answer()->cell)};
  }

 private:
  static bool before(BodyId body, const Eigen::Vector3d& cell, const Found& other) {
    return body != other.body ? body < other.body : cell_before(cell, other.cell);
  }

  double limit_;
  double declined_bound_ = std::numeric_limits<double>::infinity();
  std::optional<Found> found_;
  std::optional<Found> declined_;
};

}  // namespace geom::scene
