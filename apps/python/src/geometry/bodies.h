#pragma once

/// Bodies and threads of queries on arrays.

#include "base/arrays.h"
#include "base/orientations.h"
#include "base/parallel.h"

#include <geom/pose.h>
#include <geom/shape_variant.h>
#include <geom/tolerances.h>

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hardbody::python {

/// Bodies given by arrays: a list of shapes, and a position, an orientation and the index of a shape each.
class Bodies {
 public:
  /// Reads the arguments of these names. `quaternions` may be None: bodies are not rotated; rotation matrices and
  /// SciPy's rotations may take their place. `shape_of` may be None: `shapes` has one element, for all bodies, or one a
  /// body. `shapes` may be a single shape.
  Bodies(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle shape_of);

  std::size_t size() const { return positions_.size(); }
  const std::vector<geom::Shape>& shapes() const { return shapes_; }

  /// Returns the index of a body's shape.
  std::size_t shape_index(std::size_t body) const { return shape_of_.empty() ? 0 : shape_of_[body]; }
  const geom::Shape& shape(std::size_t body) const { return shapes_[shape_index(body)]; }

  /// Returns a body's pose. Throws ValueError, naming the entry, if position or quaternion are refused.
  geom::Pose pose(std::size_t body) const;

  /// Returns a body's pose by Pose's own functions, bit for bit. pose() is faster and differs by rounding. Throws as
  /// pose().
  geom::Pose checked_pose(std::size_t body) const;

  /// Returns a body's pose; its position is NaN where the numbers may be refused, which pose(body) decides.
  geom::Pose pose_or_nan(std::size_t body) const;

 private:
  void read_shape_of(nb::handle shape_of);
  geom::Pose pose_of_matrix(std::size_t body) const;

  std::vector<geom::Shape> shapes_;
  RealRows positions_;
  std::optional<Orientations> orientations_;
  std::vector<std::uint32_t> shape_of_;  ///< empty: 0 for all
};

inline geom::Pose Bodies::pose_or_nan(std::size_t body) const {
  const double* const p = positions_[body];
  const double px = p[0], py = p[1], pz = p[2];
  bool is_valid = std::abs(px) <= geom::kMaxCoordinate && std::abs(py) <= geom::kMaxCoordinate &&
                  std::abs(pz) <= geom::kMaxCoordinate;
  Eigen::Matrix3d R;
  if (orientations_) {
    if (orientations_->are_matrices()) return pose_of_matrix(body);
    const double* const q = (*orientations_)[body];
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double norm2 = w * w + x * x + y * y + z * z;
    // Twice the tolerance of the norm, less its rounding; what is close to it is left to Pose.
    is_valid = is_valid && std::abs(norm2 - 1) <= 1.99 * geom::kPoseTolerance;
    const double s = 2 / norm2;
    const double sx = s * x, sy = s * y, sz = s * z;
    const double xx = sx * x, yy = sy * y, zz = sz * z, xy = sx * y, xz = sx * z, yz = sy * z;
    const double wx = sx * w, wy = sy * w, wz = sz * w;
    // Column by column: Eigen's comma initialiser takes half as long again.
    double* const r = R.data();
    r[0] = 1 - (yy + zz), r[1] = xy + wz, r[2] = xz - wy;
    r[3] = xy - wz, r[4] = 1 - (xx + zz), r[5] = yz + wx;
    r[6] = xz + wy, r[7] = yz - wx, r[8] = 1 - (xx + yy);
  } else {
    R.setIdentity();
  }
  if (!is_valid) {
    return geom::kernel::unchecked_pose(R, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  }
  return geom::kernel::unchecked_pose(R, {px, py, pz});
}

inline geom::Pose Bodies::pose(std::size_t body) const {
  const geom::Pose X = pose_or_nan(body);
  return std::isnan(X.position().x()) ? checked_pose(body) : X;
}

/// Poses of bodies that are in pairs, computed in advance if most bodies are in several and there is memory for them.
/// Bodies in no pair are not checked.
class PairPoses {
 public:
  PairPoses(const Bodies& bodies, std::size_t pairs, int threads);

  /// Returns a body's pose, which is in `slot` unless it is stored. Throws as Bodies::pose.
  const geom::Pose* get(std::size_t body, geom::Pose& slot) const {
    if (stored_ && !std::isnan(stored_[body].position().x())) return &stored_[body];
    slot = bodies_.pose_or_nan(body);
    if (std::isnan(slot.position().x())) slot = bodies_.pose(body);
    return &slot;
  }

  /// Asks for the memory of a body's pose, which is needed soon.
  void prefetch(std::size_t body) const {
    if (!stored_) return;
    const double* const first = stored_[body].rotation().data();
    __builtin_prefetch(first);
    __builtin_prefetch(first + 8);
  }

 private:
  struct Free {
    std::size_t size;
    void operator()(geom::Pose* poses) const { std::allocator<geom::Pose>().deallocate(poses, size); }
  };

  const Bodies& bodies_;
  std::unique_ptr<geom::Pose[], Free> stored_;  ///< empty, or one for each body; NaN: see Bodies::pose_or_nan
};

/// Index of the body that each point or ray of a query is about.
class BodyOf {
 public:
  /// Reads `body_of`. None: there is one body, for all queries, or one a query.
  BodyOf(nb::handle body_of, const Bodies& bodies, std::size_t queries, const std::string& queries_name);

  std::size_t operator[](std::size_t query) const {
    if (indices_) return indices_->at(query, 0, bodies_);
    return bodies_ == 1 ? 0 : query;
  }

 private:
  std::size_t bodies_;
  std::optional<IndexRows> indices_;
};

/// Reads `shapes`, one shape or a list of them.
std::vector<geom::Shape> read_shapes(nb::handle shapes);

/// Returns the number of threads that a caller wants.
int thread_count(nb::handle threads);

/// Returns a length of ranges (see parallel) that keeps all threads busy and interrupts short: at most 512. Threads
/// whose ranges of 64 alternate in memory slow each other down by a fifth.
std::size_t range_length(std::size_t count, int threads);

/// Arguments of a call on pairs, checked.
struct PairQuery {
  PairQuery(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle pairs_argument,
            nb::handle shape_of, nb::handle threads, nb::handle start)
      : bodies(shapes, positions, quaternions, shape_of),
        pairs(pairs_argument, "pairs", 2),
        thread_number(thread_count(threads)),
        poses(bodies, pairs.size(), thread_number) {
    if (start.is_none()) return;
    starts.emplace(start, "start", 3);
    check_rows("start", starts->size(), "pairs", pairs.size());
  }

  /// Does the work on all pairs (see parallel).
  template <class WorkOrMake>
  void run(const WorkOrMake& work) const {
    parallel(pairs.size(), range_length(pairs.size(), thread_number), thread_number, work);
  }

  /// Calls f(row, a, X_WA, b, X_WB), a and b the indices of bodies, for all pairs (see parallel).
  template <class F>
  void for_each(const F& f) const {
    run(Work([&](std::size_t begin, std::size_t end) {
      geom::Pose slot_a, slot_b;
      for (std::size_t row = begin; row < end; ++row) {
        const std::size_t first = a(row), second = b(row);
        const geom::Pose* const X_WA = poses.get(first, slot_a);
        f(row, first, *X_WA, second, *poses.get(second, slot_b));
      }
    }));
  }

  std::size_t a(std::size_t row) const { return pairs.at(row, 0, bodies.size()); }
  std::size_t b(std::size_t row) const { return pairs.at(row, 1, bodies.size()); }

  /// Returns the guess of a pair's normal, 0 for none. Throws ValueError, naming the row, unless it is finite.
  Eigen::Vector3d start(std::size_t row) const {
    if (!starts) return Eigen::Vector3d::Zero();
    return starts->finite_vector(row);
  }

  Bodies bodies;
  IndexRows pairs;
  int thread_number;
  PairPoses poses;
  std::optional<RealRows> starts;
};

}  // namespace hardbody::python
