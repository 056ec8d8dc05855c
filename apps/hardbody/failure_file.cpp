#include "failure_file.h"

#include "errors.h"
#include "text_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "hardbody pair";
constexpr std::size_t kLongest = 1 << 20;

Json list(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json body_json(const geom::Ellipsoid& shape, const ed::Motion& motion) {
  const Matrix3d& R = motion.pose.rotation();
  return {{"shape", {{"kind", "ellipsoid"}, {"semi_axes", list(shape.semi_axes())}}},
          {"position", list(motion.pose.position())},
          {"rotation", {list(R.row(0)), list(R.row(1)), list(R.row(2))}},
          {"velocity", list(motion.velocity)},
          {"angular_velocity", list(motion.angular_velocity)},
          {"inertia", list(motion.inertia)},
          {"time", motion.time}};
}

/// A member of a JSON object, with what messages call it.
struct Member {
  const Json* json;
  std::string name;  ///< file: a.shape.semi_axes

  bool has(const char* key) const { return json->is_object() && json->contains(key); }

  Member at(const char* key, const char* accepted) const {
    const std::string full = name.ends_with(": ") ? name + key : name + "." + key;
    if (!has(key)) throw InputError(fmt::format("{} is missing; accepted: {}", full, accepted));
    return {&json->at(key), full};
  }

  InputError bad(const char* accepted) const {
    return InputError(fmt::format("{} is {}; accepted: {}", name, one_line(json->dump(), 60), accepted));
  }

  double number() const {
    if (!json->is_number() || !std::isfinite(json->get<double>())) throw bad("a finite number");
    return json->get<double>();
  }

  /// Of a body.
  int index() const {
    if (!json->is_number_integer() || json->get<std::int64_t>() < 0 || json->get<std::int64_t>() > 1'000'000'000) {
      throw bad("a body's index");
    }
    return json->get<int>();
  }

  std::vector<double> numbers(std::size_t size, const char* accepted) const {
    const auto is_number = [](const Json& x) { return x.is_number() && std::isfinite(x.get<double>()); };
    if (!json->is_array() || json->size() != size || !std::all_of(json->begin(), json->end(), is_number)) {
      throw bad(accepted);
    }
    return json->get<std::vector<double>>();
  }

  Vector3d vector() const {
    const std::vector<double> v = numbers(3, "three finite numbers");
    return {v[0], v[1], v[2]};
  }

  /// What `make` makes of it; a std::invalid_argument of the library becomes a message about this member.
  template <class Make>
  auto checked(const Make& make) const {
    try {
      return make();
    } catch (const std::invalid_argument& error) {
      throw InputError(fmt::format("{}: {}", name, one_line(error.what())));
    }
  }
};

geom::Pose read_pose(const Member& body) {
  const Vector3d position = body.at("position", "three finite numbers").vector();
  if (body.has("orientation")) {
    const Member member = body.at("orientation", "");
    const std::vector<double> q = member.numbers(4, "a unit quaternion [w, x, y, z]");
    return member.checked([&] { return geom::Pose::from_quaternion(q[0], q[1], q[2], q[3], position); });
  }
  const Member member = body.at("rotation", "the three rows of a rotation matrix (or orientation: a unit quaternion)");
  if (!member.json->is_array() || member.json->size() != 3) throw member.bad("the three rows of a rotation matrix");
  Matrix3d R;
  for (int k = 0; k < 3; ++k) {
    R.row(k) = Member{&member.json->at(static_cast<std::size_t>(k)), fmt::format("{}[{}]", member.name, k)}.vector();
  }
  return member.checked([&] { return geom::Pose(R, position); });
}

geom::Ellipsoid read_shape(const Member& body) {
  const Member shape = body.at("shape", "{\"kind\": \"ellipsoid\", \"semi_axes\": [a, b, c]}");
  if (shape.has("kind") && *shape.at("kind", "").json != "ellipsoid") throw shape.at("kind", "").bad("\"ellipsoid\"");
  const Member axes = shape.at("semi_axes", "three positive numbers");
  const Vector3d values = axes.vector();
  return axes.checked([&] { return geom::Ellipsoid(values); });
}

ed::Motion read_motion(const Member& body, const geom::Ellipsoid& shape) {
  ed::Motion motion;
  motion.pose = read_pose(body);
  if (body.has("velocity")) motion.velocity = body.at("velocity", "").vector();
  if (body.has("angular_velocity")) motion.angular_velocity = body.at("angular_velocity", "").vector();
  motion.inertia = body.has("inertia") ? body.at("inertia", "").vector() : shape.inertia(1);
  if (body.has("time")) motion.time = body.at("time", "").number();
  return motion;
}

Json parse(const std::string& text, const std::string& name) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    throw InputError(fmt::format("{}:{}: is not valid JSON; accepted: a pair as written to failures/", name, line));
  }
}

}  // namespace

std::string failure_json(const ed::FailedPair& pair) {
  const Json json = {{"format", kFormat},
                     {"reason", pair.reason},
                     {"time", pair.time},
                     {"i", pair.i},
                     {"j", pair.j},
                     {"a", body_json(pair.shape_i, pair.motion_i)},
                     {"b", body_json(pair.shape_j, pair.motion_j)}};
  return json.dump(2) + "\n";
}

ed::FailedPair read_failure(const std::filesystem::path& path) {
  const Json json = parse(read_file(path, kLongest), path.string());
  const Member root{&json, path.string() + ": "};
  const Member format = root.at("format", "\"hardbody pair\", in a file as written to failures/");
  if (*format.json != kFormat) throw format.bad("\"hardbody pair\"");
  const Member a = root.at("a", "a body");
  const Member b = root.at("b", "a body");
  ed::FailedPair pair;
  pair.shape_i = read_shape(a);
  pair.shape_j = read_shape(b);
  pair.motion_i = read_motion(a, pair.shape_i);
  pair.motion_j = read_motion(b, pair.shape_j);
  pair.reason = root.has("reason") && json["reason"].is_string() ? one_line(json["reason"].get<std::string>()) : "";
  pair.time = root.has("time") ? root.at("time", "").number() : std::max(pair.motion_i.time, pair.motion_j.time);
  pair.i = root.has("i") ? root.at("i", "").index() : 0;
  pair.j = root.has("j") ? root.at("j", "").index() : 1;
  return pair;
}

}  // namespace hardbody
