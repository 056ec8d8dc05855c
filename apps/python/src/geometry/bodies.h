#pragma once

/// Bodies and threads of queries on arrays.

#include "base/arrays.h"

#include <geom/pose.h>
#include <geom/shape_variant.h>

#include <nanobind/nanobind.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hardbody::python {

/// Bodies given by arrays: a list of shapes, and a position, an orientation and the index of a shape each.
class Bodies {
 public:
  /// Reads the arguments of these names. `quaternions` may be None: bodies are not rotated. `shape_of` may be None:
  /// `shapes` has one element, for all bodies, or one a body. `shapes` may be a single shape.
  Bodies(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle shape_of);

  std::size_t size() const { return positions_.size(); }
  const std::vector<geom::Shape>& shapes() const { return shapes_; }

  /// Returns the index of a body's shape.
  std::size_t shape_index(std::size_t body) const { return shape_of_.empty() ? 0 : shape_of_[body]; }
  const geom::Shape& shape(std::size_t body) const { return shapes_[shape_index(body)]; }

  /// Returns a body's pose. Throws ValueError, naming the entry, if its numbers are none.
  geom::Pose pose(std::size_t body) const;

  /// Returns a body's pose, or one with NaN as position if that needs a closer look: pose(body) then decides.
  geom::Pose pose_or_nan(std::size_t body) const;

 private:
  void read_shapes(nb::handle shapes);
  void read_shape_of(nb::handle shape_of);
  geom::Pose refused_pose(std::size_t body) const;

  std::vector<geom::Shape> shapes_;
  RealRows positions_;
  std::optional<RealRows> quaternions_;
  std::vector<std::uint32_t> shape_of_;  ///< empty: 0 for all
};

/// Poses of bodies that are in pairs, computed in advance if most bodies are in several. Bodies in no pair are not
/// checked.
class PairPoses {
 public:
  PairPoses(const Bodies& bodies, std::size_t pairs, int threads);

  /// Returns a body's pose, which is in `slot` unless it is stored. Throws as Bodies::pose.
  const geom::Pose* get(std::size_t body, geom::Pose& slot) const {
    if (stored_ && !std::isnan(stored_[body].position().x())) return &stored_[body];
    slot = bodies_.pose(body);
    return &slot;
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

/// Returns the number of threads that a caller wants.
int thread_count(nb::handle threads);

/// Throws ValueError unless an array has as many rows as another.
void check_rows(const std::string& name, std::size_t rows, const std::string& other, std::size_t wanted);

/// Returns a length of ranges (see parallel) that keeps all threads busy: at most 1024.
std::size_t range_length(std::size_t count, int threads);

}  // namespace hardbody::python
