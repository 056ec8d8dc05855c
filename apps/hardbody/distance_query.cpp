#include "distance_query.h"

#include "errors.h"
#include "json_member.h"
#include "text_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <utility>

namespace hardbody {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

constexpr std::string_view kQueryKeys[] = {"a", "b", "method", "seed", "id"};
constexpr std::string_view kBodyKeys[] = {"shape", "position", "orientation"};
constexpr std::string_view kEllipsoidKeys[] = {"kind", "semi_axes"};

constexpr const char* kMethods = "\"dual\", \"newton8\", \"newton5\"";

struct Body {
  geom::Ellipsoid shape;
  geom::Pose pose;
};

geom::Ellipsoid read_shape(const JsonMember& shape) {
  constexpr const char* kAccepted = "\"ellipsoid\"";
  if (!shape.json->is_object()) throw shape.bad("{\"kind\":\"ellipsoid\",\"semi_axes\":[a,b,c]}");
  const JsonMember kind = shape.at("kind", kAccepted);
  // First of all: another kind has other keys.
  if (*kind.json == "superellipsoid") {
    throw InputError(fmt::format("{} \"superellipsoid\" is not available yet; accepted: {}", kind.name, kAccepted));
  }
  if (*kind.json != "ellipsoid") throw kind.bad(kAccepted);
  shape.allow(kEllipsoidKeys);
  return read_ellipsoid(shape);
}

Body read_body(const JsonMember& body) {
  body.allow(kBodyKeys);
  const geom::Ellipsoid shape = read_shape(body.at("shape", "{\"kind\":\"ellipsoid\",\"semi_axes\":[a,b,c]}"));
  const Vector3d position = body.at("position", "three finite numbers").vector();
  if (!body.has("orientation")) return {shape, geom::Pose::translation(position)};
  return {shape, read_orientation(body.at("orientation", ""), position)};
}

/// Nothing: the dual method.
std::optional<geom::NewtonSystem> read_method(const JsonMember& query) {
  if (!query.has("method")) return {};
  const JsonMember member = query.at("method", kMethods);
  const std::string name = member.text(kMethods);
  if (name == "newton8") return geom::NewtonSystem::eight;
  if (name == "newton5") return geom::NewtonSystem::five;
  if (name != "dual") throw member.bad(kMethods);
  return {};
}

const SeedSource& read_seed(const JsonMember& query) {
  const SeedSource& standard = seed_sources().front();
  if (!query.has("seed")) return standard;
  const JsonMember member = query.at("seed", "");
  const std::string name = member.text(built_in_seeds());
  for (const SeedSource& source : seed_sources()) {
    if (source.name != name) continue;
    if (source.function != nullptr) return source;
    throw InputError(fmt::format("seed \"{}\" is not built in (CMake option {}); accepted: {}", name, source.option,
                                 built_in_seeds()));
  }
  throw member.bad(built_in_seeds());
}

json parse_line(std::string_view line) {
  try {
    return parse_json(line);
  } catch (const JsonError& error) {
    const std::string column = error.offset ? fmt::format(" at column {}", *error.offset + 1) : "";
    throw InputError(
        fmt::format("{}{}; accepted: {{\"a\":..,\"b\":..}} on one line, every number finite", error.what(), column));
  }
}

/// `null` for a number that a declined answer does not have.
std::string vector_json(bool answered, const Vector3d& v) {
  return answered ? fmt::format("[{:.17g},{:.17g},{:.17g}]", v.x(), v.y(), v.z()) : "null";
}

std::string id_json(const std::string& id) {
  return id.empty() ? "" : fmt::format("\"id\":{},", id);
}

}  // namespace

DistanceQuery parse_query(std::string_view line, std::string& id) {
  const json document = parse_line(line);
  const JsonMember root{&document, ""};
  if (root.has("id")) id = document.at("id").dump();
  root.allow(kQueryKeys);
  const std::optional<geom::NewtonSystem> newton = read_method(root);
  const SeedSource& seed = read_seed(root);
  if (!newton && &seed != &seed_sources().front()) {
    throw InputError(fmt::format(
        "seed is \"{}\", but the method \"dual\" starts from no points; accepted: with \"newton8\" or \"newton5\"",
        seed.name));
  }
  const Body a = read_body(root.at("a", "a body"));
  const Body b = read_body(root.at("b", "a body"));
  return {a.shape, b.shape, a.pose, b.pose, newton, seed.function};
}

DistanceAnswer answer(const DistanceQuery& query) {
  const auto& [a, b, X_WA, X_WB, newton, seed_function] = query;
  if (!newton) return {geom::distance(a, X_WA, b, X_WB), {}};
  const geom::WitnessPair seed = geom::checked_seed(a, X_WA, b, X_WB, seed_function(a, X_WA, b, X_WB));
  if (seed.status != geom::SeedStatus::usable) return {{}, seed.status};
  return {geom::newton_distance(a, X_WA, b, X_WB, *newton, seed), {}};
}

std::string answer_json(const std::string& id, const DistanceAnswer& answer) {
  const geom::DistanceResult& r = answer.result;
  const bool answered = r.status == geom::DistanceStatus::separated || r.status == geom::DistanceStatus::overlapping;
  std::string text =
      fmt::format("{{{}\"distance\":{},\"point_a\":{},\"point_b\":{},\"normal\":{}", id_json(id),
                  answered ? fmt::format("{:.17g}", r.distance) : "null", vector_json(answered, r.point_a),
                  vector_json(answered, r.point_b), vector_json(answered, r.normal));
  text += fmt::format(",\"status\":\"{}\",\"iterations\":{}", geom::to_string(r.status), r.iterations);
  if (answer.seed_status) text += fmt::format(",\"seed_status\":\"{}\"", geom::to_string(*answer.seed_status));
  return text + "}";
}

std::string error_json(const std::string& id, const std::string& message) {
  // A message quotes its line, cut at a byte that may be the middle of a character.
  const std::string quoted = json(message).dump(-1, ' ', false, json::error_handler_t::replace);
  return fmt::format("{{{}\"error\":{}}}", id_json(id), quoted);
}

}  // namespace hardbody
