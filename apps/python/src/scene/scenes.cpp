#include "base/arguments.h"
#include "base/arrays.h"
#include "base/parallel.h"
#include "base/unlocked.h"
#include "base/values.h"
#include "geometry/bodies.h"
#include "geometry/given/motions.h"
#include "geometry/options.h"
#include "geometry/shapes.h"
#include "scene/answers.h"
#include "scene/arguments.h"
#include "scene/bind.h"

#include <ed/given/scene.h>
#include <ed/shape.h>
#include <ed/time_of_contact.h>

#include <geom/scene.h>

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

namespace hardbody::python {
namespace {

using geom::BodyId;
using geom::Pose;

/// geom::Scene and the number of calls that read it without the GIL; while there are any, changes are refused. All
/// members are called with the GIL.
class PythonScene {
 public:
  PythonScene(nb::handle margin, nb::handle lattice)
      : scene_({.margin = margin_of(margin), .lattice = lattice_of(lattice)}) {}

  const geom::Scene& scene() const { return scene_; }

  /// Returns the shape of a body as Python has it.
  nb::object shape(nb::handle handle) const {
    const BodyId body = handle_of(handle, "body");
    const auto held = scene_.shape(body);
    if (const auto* built_in = std::get_if<geom::Shape>(&held)) {
      return std::visit([](const auto& s) { return nb::cast(s); }, *built_in);
    }
    return nb::cast(custom_shapes_.at(body));
  }

  std::int64_t add(nb::handle shape, nb::handle pose, nb::handle group, nb::handle meets) {
    const ed::BodyShape given = body_shape(shape, "shape");
    const BodyId body = idle().add(scene_shape(given), checked_pose(pose), filter_of(group, meets));
    if (const auto* custom = std::get_if<ed::CustomShape>(&given)) custom_shapes_.emplace(body, *custom);
    return static_cast<std::int64_t>(body);
  }

  nb::object add_many(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle shape_of,
                      nb::handle group, nb::handle meets) {
    const Bodies bodies(shapes, positions, quaternions, shape_of);
    const geom::Filter filter = filter_of(group, meets);
    std::vector<Pose> poses;
    poses.reserve(bodies.size());
    for (std::size_t k = 0; k < bodies.size(); ++k) poses.push_back(bodies.checked_pose(k));
    geom::Scene& scene = idle();
    std::vector<BodyId> added;
    added.reserve(bodies.size());
    try {
      for (std::size_t k = 0; k < bodies.size(); ++k) added.push_back(scene.add(bodies.shape(k), poses[k], filter));
    } catch (...) {
      for (const BodyId body : added) scene.remove(body);
      throw;
    }
    return array_of(added);
  }

  void move(nb::handle body, nb::handle pose) { idle().move(handle_of(body, "body"), checked_pose(pose)); }

  void move_many(nb::handle handles, nb::handle positions, nb::handle quaternions) {
    const std::vector<BodyId> moved = handles_of(handles);
    const Bodies bodies(nb::cast(geom::Sphere(1)), positions, quaternions, nb::none());
    check_rows("positions", bodies.size(), "bodies", moved.size());
    std::vector<Pose> poses;
    poses.reserve(bodies.size());
    for (std::size_t k = 0; k < bodies.size(); ++k) poses.push_back(bodies.checked_pose(k));
    idle().move(moved, poses);
  }

  void remove_many(nb::handle handles) {
    const std::vector<BodyId> removed = handles_of(handles);
    geom::Scene& scene = idle();
    for (std::size_t k = 0; k < removed.size(); ++k) {
      static_cast<void>(scene.pose(removed[k]));  // throws for a handle that no body has, before one is removed
    }
    for (const BodyId body : removed) {
      if (scene.has(body)) scene.remove(body);
      custom_shapes_.erase(body);
    }
  }

  void set_filter(nb::handle body, nb::handle group, nb::handle meets) {
    idle().set_filter(handle_of(body, "body"), filter_of(group, meets));
  }

  nb::tuple pairs_within(nb::handle cutoff, nb::handle threads, nb::handle max_iterations, nb::handle penetration) {
    const geom::DistanceOptions options = distance_options(max_iterations, penetration);
    const double length = finite_number(cutoff, "cutoff");
    const int number = threads_of(threads);
    std::vector<geom::ScenePair> pairs;
    read([&] { scene_.pairs_within(length, pairs, options, number); });
    return arrays_of(pairs);
  }

  nb::tuple overlapping_pairs(nb::handle threads) {
    const int number = threads_of(threads);
    std::vector<geom::SceneOverlap> pairs;
    read([&] { scene_.overlapping_pairs(pairs, number); });
    return arrays_of(pairs);
  }

  nb::tuple overlapping(nb::handle shape, nb::handle pose) {
    const geom::SceneShape given = scene_shape(body_shape(shape, "shape"));
    const Pose& X_WS = checked_pose(pose);
    std::vector<geom::SceneImage> found;
    read([&] { scene_.overlapping(given, X_WS, found); });
    return arrays_of(found);
  }

  nb::tuple distance(nb::handle i, nb::handle j, nb::handle max_iterations, nb::handle penetration) {
    const geom::DistanceOptions options = distance_options(max_iterations, penetration);
    const BodyId first = handle_of(i, "i"), second = handle_of(j, "j");
    if (first == second) {
      refuse_value("j", std::to_string(static_cast<std::uint32_t>(second)) + ", as i", "another body");
    }
    geom::ScenePair pair;
    read([&] { pair = scene_.distance(first, second, options); });
    return nb::make_tuple(array_of(pair.image), pair.result);
  }

  nb::tuple nearest(nb::handle shape, nb::handle pose, nb::handle within) {
    const geom::SceneShape given = scene_shape(body_shape(shape, "shape"));
    const Pose& X_WS = checked_pose(pose);
    const double length = reach(within, "within");
    geom::SceneNearest found;
    read([&] { found = scene_.nearest(given, X_WS, length); });
    return nb::make_tuple(place_of(found.body), found.result);
  }

  nb::tuple nearest_to(nb::handle body, nb::handle within) {
    const BodyId given = handle_of(body, "body");
    const double length = reach(within, "within");
    geom::SceneNearest found;
    read([&] { found = scene_.nearest(given, length); });
    return nb::make_tuple(place_of(found.body), found.result);
  }

  nb::tuple first_contact(nb::handle motions, nb::handle t_max, nb::handle t_min, nb::handle max_evaluations,
                          nb::handle tolerance) {
    std::vector<ed::MovingBody> moving;
    for (const auto& [key, motion] : nb::cast<nb::dict>(motions)) {
      const BodyId body = handle_of(key, "moving: a key");
      moving.push_back({body, given_motion(motion, entry("moving", static_cast<std::size_t>(body)))});
    }
    const double from = finite_number(t_min, "t_min"), until = finite_number(t_max, "t_max");
    const ed::GivenContactOptions options = given_options(max_evaluations, tolerance);
    geom::Scene& scene = idle();
    // Functions of motions let other threads run: bodies are then on their way, and queries are refused.
    const Reading reading(readers_), moving_bodies(movers_);
    const ed::SceneContact found = ed::first_contact(scene, moving, from, until, options);
    if (found.i == found.j) {
      return nb::make_tuple(nb::none(), nb::none(), nb::none(), found.contact);
    }
    return nb::make_tuple(static_cast<std::int64_t>(found.i), static_cast<std::int64_t>(found.j), array_of(found.image),
                          found.contact);
  }

  nb::tuple closest_point(nb::handle point, nb::handle within) {
    const Eigen::Vector3d p_W = finite_vector3(point, "point");
    const double length = reach(within, "within");
    geom::ScenePoint found;
    read([&] { found = scene_.closest_point(p_W, length); });
    return nb::make_tuple(place_of(found.body), found.closest);
  }

  nb::tuple ray_cast(nb::handle origin, nb::handle direction, nb::handle t_max) {
    const Eigen::Vector3d from = finite_vector3(origin, "origin"), along = direction3(direction, "direction");
    const double most = reach(t_max, "t_max");
    geom::SceneRayHit found;
    read([&] { found = scene_.ray_cast(from, along, most); });
    return nb::make_tuple(place_of(found.body), found.hit);
  }

  nb::tuple closest_point_many(nb::handle points, nb::handle within, nb::handle threads) {
    const RealRows rows(points, "points", 3);
    const double length = reach(within, "within");
    const std::size_t count = rows.size();
    const ImageColumns body(count);
    const auto distance = new_array<double>({count}), error_bound = new_array<double>({count});
    const auto point = new_array<double>({count, 3}), normal = new_array<double>({count, 3});
    const auto status = new_array<std::uint8_t>({count});
    for_rows(count, threads, [&](std::size_t row) {
      const geom::ScenePoint found = scene_.closest_point(rows.finite_vector(row), length);
      body.put(row, found.body);
      distance.data[row] = found.closest.distance;
      error_bound.data[row] = found.closest.error_bound;
      Eigen::Vector3d::Map(point.data + 3 * row) = found.closest.point;
      Eigen::Vector3d::Map(normal.data + 3 * row) = found.closest.normal;
      status.data[row] = static_cast<std::uint8_t>(found.closest.status);
    });
    return nb::make_tuple(distance.array, point.array, normal.array, error_bound.array, status.array, body.body.array,
                          body.image.array);
  }

  nb::tuple ray_cast_many(nb::handle origins, nb::handle directions, nb::handle t_max, nb::handle threads) {
    const RealRows from(origins, "origins", 3), along(directions, "directions", 3);
    check_rows("directions", along.size(), "origins", from.size());
    const double most = reach(t_max, "t_max");
    const std::size_t count = from.size();
    const ImageColumns body(count);
    const auto t = new_array<double>({count});
    const auto point = new_array<double>({count, 3}), normal = new_array<double>({count, 3});
    const auto status = new_array<std::uint8_t>({count});
    for_rows(count, threads, [&](std::size_t row) {
      const Eigen::Vector3d direction = along.finite_vector(row);
      if (direction.isZero(0)) refuse_value(entry("directions", row), "zero", "vectors other than 0");
      const geom::SceneRayHit found = scene_.ray_cast(from.finite_vector(row), direction, most);
      body.put(row, found.body);
      t.data[row] = found.hit.t;
      Eigen::Vector3d::Map(point.data + 3 * row) = found.hit.point;
      Eigen::Vector3d::Map(normal.data + 3 * row) = found.hit.normal;
      status.data[row] = static_cast<std::uint8_t>(found.hit.status);
    });
    return nb::make_tuple(t.array, point.array, normal.array, status.array, body.body.array, body.image.array);
  }

 private:
  /// Counts a call that reads the scene.
  class Reading {
   public:
    explicit Reading(int& readers) : readers_(readers) { ++readers_; }
    ~Reading() { --readers_; }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

   private:
    int& readers_;
  };

  /// Returns the scene, to be changed. Throws RuntimeError while another thread, or a shape's method, is in a query.
  geom::Scene& idle() {
    if (readers_ != 0) throw std::runtime_error("Scene: a query is running; accepted: changes when it has returned");
    return scene_;
  }

  /// Throws RuntimeError while bodies are being moved.
  void check_rest() const {
    if (movers_ == 0) return;
    throw std::runtime_error("Scene: first_contact is running; accepted: queries when it has returned");
  }

  template <class Query>
  void read(const Query& query) {
    check_rest();
    const Reading reading(readers_);
    unlocked(query);
  }

  template <class Row>
  void for_rows(std::size_t count, nb::handle threads, const Row& row_answer) {
    const int number = threads_of(threads);
    check_rest();
    const Reading reading(readers_);
    parallel(count, range_length(count, number), number, Work([&](std::size_t begin, std::size_t end) {
               for (std::size_t row = begin; row < end; ++row) row_answer(row);
             }));
  }

  /// Returns the number of threads: 1 where shapes are written in Python, which runs one thread at a time.
  int threads_of(nb::handle threads) const {
    const int number = thread_count(threads);
    return custom_shapes_.empty() ? number : 1;
  }

  geom::Scene scene_;
  int readers_ = 0;
  int movers_ = 0;  ///< number of calls of first_contact that run
  std::unordered_map<BodyId, ed::CustomShape> custom_shapes_;
};

/// Defines a method whose arguments the package's Scene has checked the names of.
template <class Method, class... Name>
void define(nb::class_<PythonScene>& type, const char* name, Method method, const char* result, Name... arguments) {
  std::string signature = std::string("def ") + name + "(self";
  ((signature += std::string(", ") + arguments + ": typing.Any"), ...);
  signature += std::string(") -> ") + result;
  type.def(name, method, nb::arg(arguments).none()..., nb::sig(signature.c_str()));
}

}  // namespace

void bind_scenes(nb::module_& module) {
  using P = PythonScene;
  constexpr const char* kArray = "numpy.typing.NDArray[numpy.int64]";
  constexpr const char* kTuple = "tuple[typing.Any, ...]";
  nb::class_<P> type(module, "Scene", nb::is_weak_referenceable(), "Compiled part of hardbody.Scene.");
  type.def(nb::init<nb::handle, nb::handle>(), nb::arg("margin").none(), nb::arg("lattice").none(),
           nb::sig("def __init__(self, margin: typing.Any, lattice: typing.Any) -> None"));
  define(type, "add", &P::add, "int", "shape", "pose", "group", "meets");
  define(type, "add_many", &P::add_many, kArray, "shapes", "positions", "quaternions", "shape_of", "group", "meets");
  define(type, "move", &P::move, "None", "body", "pose");
  define(type, "move_many", &P::move_many, "None", "bodies", "positions", "quaternions");
  define(type, "remove_many", &P::remove_many, "None", "bodies");
  define(type, "set_filter", &P::set_filter, "None", "body", "group", "meets");
  define(type, "pairs_within", &P::pairs_within, kTuple, "cutoff", "threads", "max_iterations", "penetration");
  define(type, "overlapping_pairs", &P::overlapping_pairs, kTuple, "threads");
  define(type, "overlapping", &P::overlapping, kTuple, "shape", "pose");
  define(type, "distance", &P::distance, kTuple, "i", "j", "max_iterations", "penetration");
  define(type, "nearest", &P::nearest, kTuple, "shape", "pose", "within");
  define(type, "nearest_to", &P::nearest_to, kTuple, "body", "within");
  define(type, "first_contact", &P::first_contact, kTuple, "moving", "t_max", "t_min", "max_evaluations", "tolerance");
  define(type, "closest_point", &P::closest_point, kTuple, "point", "within");
  define(type, "ray_cast", &P::ray_cast, kTuple, "origin", "direction", "t_max");
  define(type, "closest_point_many", &P::closest_point_many, kTuple, "points", "within", "threads");
  define(type, "ray_cast_many", &P::ray_cast_many, kTuple, "origins", "directions", "t_max", "threads");
  define(
      type, "bodies", [](const P& s) { return array_of(s.scene().bodies()); }, kArray);
  define(
      type, "has", [](const P& s, nb::handle body) { return s.scene().has(handle_of(body, "body")); }, "bool", "body");
  define(
      type, "pose", [](const P& s, nb::handle body) { return s.scene().pose(handle_of(body, "body")); }, "Pose",
      "body");
  define(
      type, "shape", [](const P& s, nb::handle body) { return s.shape(body); }, "typing.Any", "body");
  define(
      type, "filter",
      [](const P& s, nb::handle body) {
        const geom::Filter f = s.scene().filter(handle_of(body, "body"));
        return nb::make_tuple(f.group, f.meets);
      },
      "tuple[int, int]", "body");
  define(
      type, "size", [](const P& s) { return s.scene().size(); }, "int");
  refuse_pickling(type, "a Scene", "its shapes and poses");
}

}  // namespace hardbody::python
