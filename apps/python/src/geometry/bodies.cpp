#include "geometry/bodies.h"

#include "base/arguments.h"
#include "base/parallel.h"
#include "geometry/shapes.h"

#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

namespace hardbody::python {
namespace {

constexpr std::size_t kMostShapes = std::numeric_limits<std::uint32_t>::max();

constexpr const char* kOrientations = "quaternions";

std::optional<Orientations> optional_orientations(nb::handle value) {
  if (value.is_none()) return std::nullopt;
  return Orientations(value, kOrientations);
}

bool is_sequence(nb::handle value) {
  return nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value);
}

/// Returns memory for poses; null if none is available.
geom::Pose* allocated_poses(std::size_t count) {
  try {
    return std::allocator<geom::Pose>().allocate(count);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

}  // namespace

Bodies::Bodies(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle shape_of)
    : positions_(positions, "positions", 3), orientations_(optional_orientations(quaternions)) {
  if (orientations_) check_rows(kOrientations, orientations_->size(), "positions", size());
  shapes_ = read_shapes(shapes);
  read_shape_of(shape_of);
}

void Bodies::read_shape_of(nb::handle shape_of) {
  if (!shape_of.is_none()) {
    const IndexRows indices(shape_of, "shape_of", 1);
    check_rows("shape_of", indices.size(), "positions", size());
    shape_of_.resize(size());
    for (std::size_t k = 0; k < size(); ++k)
      shape_of_[k] = static_cast<std::uint32_t>(indices.at(k, 0, shapes_.size(), "shapes"));
    return;
  }
  if (shapes_.size() == 1 || size() == 0) return;
  if (shapes_.size() != size()) {
    throw nb::value_error(("shapes has " + std::to_string(shapes_.size()) + " elements for " + std::to_string(size()) +
                           " bodies; accepted: one, one a body, or any number with shape_of")
                              .c_str());
  }
  shape_of_.resize(size());
  for (std::size_t k = 0; k < size(); ++k) shape_of_[k] = static_cast<std::uint32_t>(k);
}

geom::Pose Bodies::checked_pose(std::size_t body) const {
  std::string name = "positions";
  try {
    const auto position = geom::Pose::translation(Eigen::Vector3d::Map(positions_[body])).position();
    if (!orientations_) return geom::Pose::translation(position);
    name = kOrientations;
    return orientations_->pose(body, position);
  } catch (const std::invalid_argument& error) {
    throw nb::value_error((entry(name, body) + ": " + error.what()).c_str());
  }
}

geom::Pose Bodies::pose_of_matrix(std::size_t body) const {
  try {
    return orientations_->pose(body, Eigen::Vector3d::Map(positions_[body]));
  } catch (const std::invalid_argument&) {
    return geom::kernel::unchecked_pose(Eigen::Matrix3d::Identity(),
                                        Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  }
}

PairPoses::PairPoses(const Bodies& bodies, std::size_t pairs, int threads)
    : bodies_(bodies), stored_(nullptr, Free{bodies.size()}) {
  // Computing a pose takes about as long as writing it to new memory and reading it again.
  if (bodies.size() > pairs) return;
  stored_.reset(allocated_poses(bodies.size()));
  if (!stored_) return;
  parallel(bodies.size(), range_length(bodies.size(), threads), threads, Work([&](std::size_t begin, std::size_t end) {
             for (std::size_t k = begin; k < end; ++k) std::construct_at(&stored_[k], bodies.pose_or_nan(k));
           }));
}

BodyOf::BodyOf(nb::handle body_of, const Bodies& bodies, std::size_t queries, const std::string& queries_name)
    : bodies_(bodies.size()) {
  if (!body_of.is_none()) {
    indices_.emplace(body_of, "body_of", 1);
    check_rows("body_of", indices_->size(), queries_name, queries);
    return;
  }
  if (bodies_ == 1 || bodies_ == queries) return;
  throw nb::value_error((queries_name + " has " + std::to_string(queries) + " rows for " + std::to_string(bodies_) +
                         " bodies; accepted: any number for one body, one a body, or any number with body_of")
                            .c_str());
}

std::vector<geom::Shape> read_shapes(nb::handle shapes) {
  if (!is_sequence(shapes)) return {OneOf<geom::Shape>::from(shapes, "shapes", ", or a list of them")};
  const std::size_t count = nb::len(shapes);
  if (count > kMostShapes) refuse_value("number of shapes", std::to_string(count), "at most 4294967295");
  std::vector<geom::Shape> read;
  read.reserve(count);
  for (std::size_t k = 0; k < count; ++k) read.push_back(shape(shapes[k], entry("shapes", k)));
  return read;
}

int thread_count(nb::handle threads) {
  return static_cast<int>(integer(threads, "threads", 1, kMostThreads));
}

std::size_t range_length(std::size_t count, int threads) {
  return std::clamp<std::size_t>(count / (8 * static_cast<std::size_t>(threads)), 16, 512);
}

}  // namespace hardbody::python
