#include "run/files/failure_file.h"

#include "base/errors.h"
#include "base/shapes.h"
#include "io/json_member.h"
#include "io/json_shape.h"
#include "io/json_values.h"
#include "io/text_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace hardbody {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr const char* kPairFormat = "hardbody pair";
constexpr std::size_t kLongestPair = 1 << 20;
constexpr const char* kNewtonMethods = "\"newton8\" or \"newton5\"";

Json placed_json(const ed::BodyShape& shape, const geom::Pose& pose) {
  const Matrix3d& R = pose.rotation();
  return {{"shape", shape_json(shape)},
          {"position", list_json(pose.position())},
          {"rotation", {list_json(R.row(0)), list_json(R.row(1)), list_json(R.row(2))}}};
}

Json body_json(const ed::BodyShape& shape, const ed::Motion& motion) {
  Json json = placed_json(shape, motion.pose);
  json["velocity"] = list_json(motion.velocity);
  json["angular_velocity"] = list_json(motion.angular_velocity);
  json["inertia"] = list_json(motion.inertia);
  json["time"] = motion.time;
  return json;
}

Json newton_json(const ed::FailedDistance& call) {
  const bool seeded = call.seed.status == geom::SeedStatus::usable;
  return {{"method", call.method == ed::DistanceMethod::newton8 ? "newton8" : "newton5"},
          {"status", geom::to_string(call.status)},
          {"point_a", seeded ? list_json(call.seed.point_a) : Json(nullptr)},
          {"point_b", seeded ? list_json(call.seed.point_b) : Json(nullptr)},
          {"a", placed_json(body_shape(call.shape_a), call.X_WA)},
          {"b", placed_json(body_shape(call.shape_b), call.X_WB)}};
}

/// A body's index.
int read_index(const JsonMember& member) {
  const nlohmann::json& json = *member.json;
  if (!json.is_number_integer() || json.get<std::int64_t>() < 0 || json.get<std::int64_t>() > 1'000'000'000) {
    throw member.bad("a body's index");
  }
  return json.get<int>();
}

enum class Rounding { removed, kept };

/// A rotation that is orthonormal to rounding only is made exactly so, unless its bits are wanted.
geom::Pose read_pose(const JsonMember& body, std::vector<std::string>& notices, Rounding rounding) {
  const Vector3d position = read_position(body);
  if (body.has("orientation")) return read_orientation(body.at("orientation", ""), position, notices);
  const JsonMember member =
      body.at("rotation", "the three rows of a rotation matrix (or orientation: a unit quaternion)");
  if (!member.json->is_array() || member.json->size() != 3) throw member.bad("the three rows of a rotation matrix");
  Matrix3d R;
  for (int k = 0; k < 3; ++k) {
    R.row(k) =
        JsonMember{&member.json->at(static_cast<std::size_t>(k)), fmt::format("{}[{}]", member.name, k)}.vector();
  }
  const geom::Pose pose = member.checked([&] { return geom::Pose(R, position); });
  return rounding == Rounding::kept ? geom::kernel::unchecked_pose(R, position) : pose;
}

/// Reads a shape; one without a kind is an ellipsoid.
geom::Shape read_geom_shape(const JsonMember& body) {
  const JsonMember shape = body.at("shape", "{\"kind\": \"ellipsoid\", \"semi_axes\": [a, b, c]}");
  return shape.has("kind") ? read_shape(shape) : read_shape(shape, ShapeKind::ellipsoid);
}

ed::BodyShape read_body_shape(const JsonMember& body) {
  return body_shape(read_geom_shape(body));
}

ed::Motion read_motion(const JsonMember& body, const ed::BodyShape& shape, std::vector<std::string>& notices) {
  ed::Motion motion;
  motion.pose = read_pose(body, notices, Rounding::removed);
  if (body.has("velocity")) motion.velocity = body.at("velocity", "").vector();
  if (body.has("angular_velocity")) motion.angular_velocity = body.at("angular_velocity", "").vector();
  motion.inertia = body.has("inertia") ? body.at("inertia", "").vector() : ed::uniform_species(shape).inertia;
  if (body.has("time")) motion.time = body.at("time", "").number();
  return motion;
}

ed::DistanceMethod read_newton_method(const JsonMember& method) {
  const std::string name = method.text(kNewtonMethods);
  if (name != "newton8" && name != "newton5") throw method.bad(kNewtonMethods);
  return name == "newton8" ? ed::DistanceMethod::newton8 : ed::DistanceMethod::newton5;
}

geom::DistanceStatus read_status(const JsonMember& status) {
  using Status = geom::DistanceStatus;
  const std::string name = status.text("the status of a distance");
  for (const Status known : {Status::separated, Status::overlapping, Status::not_converged, Status::singular}) {
    if (name == geom::to_string(known)) return known;
  }
  throw status.bad("the status of a distance");
}

ed::FailedDistance read_newton(const JsonMember& newton, std::vector<std::string>& notices) {
  const JsonMember a = newton.at("a", "a body");
  const JsonMember b = newton.at("b", "a body");
  ed::FailedDistance call;
  call.method = read_newton_method(newton.at("method", kNewtonMethods));
  call.status = read_status(newton.at("status", "the status of a distance"));
  call.shape_a = read_geom_shape(a);
  call.shape_b = read_geom_shape(b);
  call.X_WA = read_pose(a, notices, Rounding::kept);
  call.X_WB = read_pose(b, notices, Rounding::kept);
  const JsonMember point_a = newton.at("point_a", "three finite numbers or null");
  const JsonMember point_b = newton.at("point_b", "three finite numbers or null");
  if (point_a.json->is_null() && point_b.json->is_null()) return call;
  call.seed = {point_a.vector(), point_b.vector(), geom::SeedStatus::usable};
  return call;
}

Failure read_pair(const JsonMember& root) {
  const JsonMember format = root.at("format", "\"hardbody pair\", in a file as written to failures/");
  if (*format.json != kPairFormat) throw format.bad("\"hardbody pair\"");
  const JsonMember a = root.at("a", "a body");
  const JsonMember b = root.at("b", "a body");
  Failure failure;
  ed::FailedPair& pair = failure.pair;
  pair.shape_i = read_body_shape(a);
  pair.shape_j = read_body_shape(b);
  pair.motion_i = read_motion(a, pair.shape_i, failure.notices);
  pair.motion_j = read_motion(b, pair.shape_j, failure.notices);
  if (root.has("reason") && root.json->at("reason").is_string()) {
    failure.reason = one_line(root.json->at("reason").get<std::string>());
  }
  pair.time = root.has("time") ? root.at("time", "").number() : std::max(pair.motion_i.time, pair.motion_j.time);
  pair.i = root.has("i") ? read_index(root.at("i", "")) : 0;
  pair.j = root.has("j") ? read_index(root.at("j", "")) : 1;
  if (root.has("eps_d")) {
    pair.finder = ed::Finder::bracketing;
    pair.eps_d = root.at("eps_d", "").number();
  }
  if (root.has("newton")) {
    pair.reason = ed::FailureReason::distance;
    pair.distance = read_newton(root.at("newton", ""), failure.notices);
  }
  return failure;
}

/// file:line, if the line is known.
std::string where(const std::string& name, const std::string& text, const JsonError& error) {
  if (!error.offset) return name;
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(*error.offset);
  return fmt::format("{}:{}", name, 1 + std::count(text.begin(), end, '\n'));
}

}  // namespace

std::string failure_json(const Failure& failure) {
  const ed::FailedPair& pair = failure.pair;
  Json json = {{"format", kPairFormat},
               {"reason", failure.reason},
               {"time", pair.time},
               {"i", pair.i},
               {"j", pair.j},
               {"a", body_json(pair.shape_i, pair.motion_i)},
               {"b", body_json(pair.shape_j, pair.motion_j)}};
  if (pair.finder == ed::Finder::bracketing) json["eps_d"] = pair.eps_d;
  if (pair.distance) json["newton"] = newton_json(*pair.distance);
  return json.dump(2) + "\n";
}

Failure read_failure(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string text = read_file(path, kLongestPair);
  try {
    const nlohmann::json json = parse_json(text);
    return read_pair({&json, ""});
  } catch (const JsonError& error) {
    throw InputError(
        fmt::format("{}: {}; accepted: a pair as written to failures/", where(name, text, error), error.what()));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace hardbody
