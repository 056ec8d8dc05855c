#include "base/arguments.h"
#include "base/arrays.h"
#include "base/parallel.h"
#include "geometry/bind.h"
#include "geometry/bodies.h"
#include "geometry/contact_options.h"
#include "geometry/speeds.h"

#include <ed/motion.h>
#include <ed/shape.h>
#include <ed/time_of_contact.h>

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace hardbody::python {
namespace {

/// Largest number of searches between two looks after signals: each may take milliseconds.
constexpr std::size_t kMostSearches = 8;

/// Bodies in free motion, given by arrays: their states at time 0.
class MovingBodies {
 public:
  /// Reads the arguments of these names. All but the first two may be None: bodies that are not rotated, at rest, not
  /// turning, with moments of 1.
  MovingBodies(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle velocities,
               nb::handle angular_velocities, nb::handle inertias, nb::handle shape_of)
      : bodies_(shapes, positions, quaternions, shape_of) {
    read(velocities_, velocities, "velocities");
    read(angular_velocities_, angular_velocities, "angular_velocities");
    read(inertias_, inertias, "inertias");
    for (const geom::Shape& shape : bodies_.shapes()) {
      shapes_.push_back(std::visit([](const auto& s) { return ed::BodyShape(s); }, shape));
    }
  }

  std::size_t size() const { return bodies_.size(); }
  const ed::BodyShape& shape(std::size_t body) const { return shapes_[bodies_.shape_index(body)]; }

  /// Returns a body's motion. Throws ValueError, naming the entry, if numbers are not finite or speeds out of range;
  /// moments are not checked.
  ed::Motion motion(std::size_t body) const {
    ed::Motion motion;
    motion.pose = bodies_.checked_pose(body);
    if (velocities_) motion.velocity = speed_of(*velocities_, "velocities", body);
    if (angular_velocities_) motion.angular_velocity = speed_of(*angular_velocities_, "angular_velocities", body);
    if (inertias_) motion.inertia = inertias_->finite_vector(body);
    return motion;
  }

 private:
  /// Returns a velocity, checked.
  static Eigen::Vector3d speed_of(const RealRows& rows, const char* name, std::size_t body) {
    return checked_speed(rows.finite_vector(body), entry(name, body));
  }

  void read(std::optional<RealRows>& rows, nb::handle value, const char* name) const {
    if (value.is_none()) return;
    rows.emplace(value, name, 3);
    check_rows(name, rows->size(), "positions", size());
  }

  Bodies bodies_;
  std::vector<ed::BodyShape> shapes_;
  std::optional<RealRows> velocities_, angular_velocities_, inertias_;
};

/// Throws ValueError with a message of the library, and the entry that it is about in front.
[[noreturn]] void refuse_entry(const char* name, std::size_t row, const std::invalid_argument& error) {
  throw nb::value_error((entry(name, row) + ": " + error.what()).c_str());
}

/// Throws ValueError, naming the entry, if a body's moments are such that no body has them.
void refuse_inertia(const ed::Motion& motion, std::size_t body) {
  try {
    static_cast<void>(ed::propagate(motion, motion.time));
  } catch (const std::invalid_argument& error) {
    refuse_entry("inertias", body, error);
  }
}

/// Returns the contact of two bodies. Throws ValueError, naming the entry, for what the library refuses.
ed::ContactResult contact_of_pair(const MovingBodies& bodies, std::size_t a, std::size_t b, std::size_t row,
                                  double t_max, const ed::ContactOptions& options) {
  const ed::Motion motion_a = bodies.motion(a), motion_b = bodies.motion(b);
  try {
    return ed::time_of_contact(bodies.shape(a), motion_a, bodies.shape(b), motion_b, t_max, options);
  } catch (const std::invalid_argument& error) {
    refuse_inertia(motion_a, a);
    refuse_inertia(motion_b, b);
    refuse_entry("pairs", row, error);
  }
}

nb::tuple time_of_contact_many(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle velocities,
                               nb::handle angular_velocities, nb::handle pairs_argument, nb::handle t_max,
                               nb::handle shape_of, nb::handle threads, nb::handle inertias, nb::handle finder,
                               nb::handle max_evaluations, nb::handle eps_d, nb::handle distance, nb::handle root) {
  const ed::ContactOptions options = contact_options(finder, max_evaluations, eps_d, distance, root);
  const MovingBodies bodies(shapes, positions, quaternions, velocities, angular_velocities, inertias, shape_of);
  const IndexRows pairs(pairs_argument, "pairs", 2);
  const double until = number(t_max, "t_max");
  if (!(until >= 0)) refuse_value("t_max", shown(until), "a number from 0, which may be infinite");
  const int thread_number = thread_count(threads);
  const std::size_t rows = pairs.size();
  const NewArray<double> time = new_array<double>({rows});
  const NewArray<double> point = new_array<double>({rows, 3}), normal = new_array<double>({rows, 3});
  const NewArray<std::int32_t> evaluations = new_array<std::int32_t>({rows}), rescues = new_array<std::int32_t>({rows});
  const NewArray<std::uint8_t> status = new_array<std::uint8_t>({rows});
  parallel(rows, std::min(kMostSearches, range_length(rows, thread_number)), thread_number,
           Work([&](std::size_t begin, std::size_t end) {
             for (std::size_t row = begin; row < end; ++row) {
               const std::size_t a = pairs.at(row, 0, bodies.size()), b = pairs.at(row, 1, bodies.size());
               const ed::ContactResult r = contact_of_pair(bodies, a, b, row, until, options);
               time.data[row] = r.time;
               Eigen::Vector3d::Map(point.data + 3 * row) = r.point;
               Eigen::Vector3d::Map(normal.data + 3 * row) = r.normal;
               evaluations.data[row] = r.evaluations;
               rescues.data[row] = r.rescues;
               status.data[row] = static_cast<std::uint8_t>(r.status);
             }
           }));
  return nb::make_tuple(time.array, point.array, normal.array, evaluations.array, rescues.array, status.array);
}

}  // namespace

void bind_contacts(nb::module_& module) {
  const auto required = [](const char* name) { return nb::arg(name).none(); };
  module.def("time_of_contact_many", &time_of_contact_many, required("shapes"), required("positions"),
             required("quaternions"), required("velocities"), required("angular_velocities"), required("pairs"),
             required("t_max"), required("shape_of"), required("threads"), required("inertias"), required("finder"),
             required("max_evaluations"), required("eps_d"), required("distance"), required("root"),
             nb::sig("def time_of_contact_many(shapes: typing.Any, positions: typing.Any, quaternions: typing.Any, "
                     "velocities: typing.Any, angular_velocities: typing.Any, pairs: typing.Any, t_max: typing.Any, "
                     "shape_of: typing.Any, threads: typing.Any, inertias: typing.Any, finder: typing.Any, "
                     "max_evaluations: typing.Any, eps_d: typing.Any, distance: typing.Any, root: typing.Any) "
                     "-> tuple[typing.Any, ...]"));
}

}  // namespace hardbody::python
