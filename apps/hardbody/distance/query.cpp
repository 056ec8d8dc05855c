#include "distance/query.h"

#include "base/errors.h"
#include "base/find.h"
#include "base/shapes.h"
#include "distance/bodies.h"
#include "distance/json_text.h"
#include "distance/queries.h"
#include "distance/scanner.h"
#include "io/json_member.h"
#include "io/orientation.h"
#include "io/text_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Vector3d;

constexpr std::string_view kQueryKeys[] = {"a", "b", "method", "seed", "penetration", "id", "query"};

constexpr const char* kMethods = "\"dual\", \"newton8\", \"newton5\"";
constexpr const char* kPenetrations = "\"global\", \"local\"";

/// Returns the method of this name; nullopt if there is none.
std::optional<Method> find_method(std::string_view name) {
  if (name == "dual") return Method::dual;
  if (name == "newton8") return Method::newton8;
  if (name == "newton5") return Method::newton5;
  return {};
}

std::optional<geom::Penetration> find_penetration(std::string_view name) {
  if (name == "global") return geom::Penetration::global;
  if (name == "local") return geom::Penetration::local;
  return {};
}

/// Returns the seed of this name; nullptr if there is none. Its function is null if it is not built in.
const SeedSource* find_seed(std::string_view name) {
  const std::span<const SeedSource> sources = seed_sources();
  return find_by(sources, &SeedSource::name, name);
}

/// Returns the value of a key whose words `find` knows; `usual` without that key.
template <class Choice>
Choice read_choice(const JsonMember& query, const char* key, std::optional<Choice> (*find)(std::string_view),
                   const char* accepted, Choice usual) {
  if (!query.has(key)) return usual;
  const JsonMember member = query.at(key, accepted);
  const std::optional<Choice> choice = find(member.text(accepted));
  if (!choice) throw member.bad(accepted);
  return *choice;
}

const SeedSource& read_seed(const JsonMember& query) {
  if (!query.has("seed")) return seed_sources().front();
  const JsonMember member = query.at("seed", "");
  const SeedSource* source = find_seed(member.text(built_in_seeds()));
  if (source == nullptr) throw member.bad(built_in_seeds());
  if (source->function != nullptr) return *source;
  throw InputError(fmt::format("seed \"{}\" is not built in (CMake option {}); accepted: {}", source->name,
                               source->option, built_in_seeds()));
}

/// Throws for options that cannot be combined.
void check_options(Method method, const SeedSource& seed, bool has_penetration) {
  if (method == Method::dual && &seed != &seed_sources().front()) {
    throw InputError(fmt::format(
        "seed is \"{}\", but the method \"dual\" starts from no points; accepted: with \"newton8\" or \"newton5\"",
        seed.name));
  }
  if (method != Method::dual && has_penetration) {
    throw InputError("penetration is for the method \"dual\"; accepted: without a method, or with \"dual\"");
  }
}

/// Throws for bodies whose distance is not defined, or not by the method.
void check_shapes(const QueryShape& a, const QueryShape& b, Method method) {
  if (std::holds_alternative<geom::HalfSpace>(a) && std::holds_alternative<geom::HalfSpace>(b)) {
    throw InputError("a.shape and b.shape are half-spaces; accepted: one at the most");
  }
  if (method == Method::dual) return;
  for (const auto& [name, shape] : {std::pair("a", &a), std::pair("b", &b)}) {
    const auto* finite = std::get_if<geom::Shape>(shape);
    if (finite != nullptr && geom::has_equations(*finite)) continue;
    throw InputError(fmt::format(
        "{}.shape is a {}, for which there are no equations; accepted: with \"newton8\" and \"newton5\" ellipsoids, "
        "superellipsoids and spheres",
        name, finite == nullptr ? "half-space" : geom::description(*finite)));
  }
}

nlohmann::json parse_line(std::string_view line) {
  try {
    return parse_json(line);
  } catch (const JsonError& error) {
    const std::string column = error.offset ? fmt::format(" at column {}", *error.offset + 1) : "";
    throw InputError(
        fmt::format("{}{}; accepted: {{\"a\":..,\"b\":..}} on one line, every number finite", error.what(), column));
  }
}

/// Converts a body found by scan_query; nullopt if it has an error.
std::optional<QueryBody> scanned_body(const ScannedBody& body, const char* name, std::vector<std::string>& notices) {
  const Vector3d axes(body.semi_axes.data());
  const Vector3d position(body.position.data());
  try {
    const JsonOrientation read = body.orientation ? read_quaternion(*body.orientation, position)
                                                  : JsonOrientation{geom::Pose::translation(position)};
    if (read.normalized) notices.push_back(normalized_text(fmt::format("{}.orientation", name), read.length));
    return QueryBody{make_shape({body.kind, axes, Eigen::Vector2d(body.exponents.data())}), read.pose};
  } catch (const std::invalid_argument&) {
    return {};
  }
}

std::optional<DistanceQuery> scanned_query(std::string_view line, std::string& id) {
  const std::optional<ScannedQuery> scanned = scan_query(line);
  if (!scanned) return {};
  const auto or_else = [](std::string_view name, std::string_view otherwise) {
    return name.empty() ? otherwise : name;
  };
  const std::optional<Method> method = find_method(or_else(scanned->method, "dual"));
  const std::optional<geom::Penetration> penetration = find_penetration(or_else(scanned->penetration, "global"));
  const SeedSource* seed = find_seed(or_else(scanned->seed, seed_sources().front().name));
  if (!method || !penetration || seed == nullptr || seed->function == nullptr) return {};
  std::vector<std::string> notices;
  const std::optional<QueryBody> a = scanned_body(scanned->a, "a", notices);
  const std::optional<QueryBody> b = scanned_body(scanned->b, "b", notices);
  if (!a || !b) return {};
  id = scanned->id;
  check_options(*method, *seed, !scanned->penetration.empty());
  return DistanceQuery{a->shape, b->shape,       a->pose,      b->pose,
                       *method,  seed->function, *penetration, fmt::format("{}", fmt::join(notices, "; "))};
}

geom::DistanceResult dual_distance(const DistanceQuery& query) {
  const auto* a = std::get_if<geom::Shape>(&query.a);
  const auto* b = std::get_if<geom::Shape>(&query.b);
  const geom::DistanceOptions options{.penetration = query.penetration};
  if (a == nullptr) return geom::distance(std::get<geom::HalfSpace>(query.a), query.X_WA, *b, query.X_WB, options);
  if (b == nullptr) {
    return geom::kernel::exchanged(
        geom::distance(std::get<geom::HalfSpace>(query.b), query.X_WB, *a, query.X_WA, options));
  }
  return geom::distance(*a, query.X_WA, *b, query.X_WB, options);
}

/// Returns the document's root; the JSON text of "id" is stored in `id`.
JsonMember root_of(const nlohmann::json& document, std::string& id) {
  JsonMember root{&document, ""};
  if (root.has("id")) id = document.at("id").dump();
  return root;
}

DistanceQuery read_query(const JsonMember& root) {
  root.allow(kQueryKeys);
  const Method method = read_choice(root, "method", find_method, kMethods, Method::dual);
  const SeedSource& seed = read_seed(root);
  const geom::Penetration penetration = read_penetration(root);
  check_options(method, seed, root.has("penetration"));
  std::vector<std::string> notices;
  const QueryBody a = read_body(root.at("a", "a body"), notices);
  const QueryBody b = read_body(root.at("b", "a body"), notices);
  check_shapes(a.shape, b.shape, method);
  return {a.shape, b.shape,       a.pose,      b.pose,
          method,  seed.function, penetration, fmt::format("{}", fmt::join(notices, "; "))};
}

/// Returns the line that answers a query.
std::string reply_text(std::string_view line, std::string& id) {
  if (const std::optional<DistanceQuery> query = scanned_query(line, id)) {
    return answer_json(id, answer(*query), query->notice);
  }
  const nlohmann::json document = parse_line(line);
  const JsonMember root = root_of(document, id);
  const std::string name = query_name(root);
  if (name != "distance") return query_answer(name, root, id);
  const DistanceQuery query = read_query(root);
  return answer_json(id, answer(query), query.notice);
}

}  // namespace

geom::Penetration read_penetration(const JsonMember& query) {
  return read_choice(query, "penetration", find_penetration, kPenetrations, geom::Penetration::global);
}

DistanceQuery parse_query(std::string_view line, std::string& id) {
  if (std::optional<DistanceQuery> query = scanned_query(line, id)) return *std::move(query);
  const nlohmann::json document = parse_line(line);
  return read_query(root_of(document, id));
}

DistanceAnswer answer(const DistanceQuery& query) {
  const geom::Pose& X_WA = query.X_WA;
  const geom::Pose& X_WB = query.X_WB;
  if (query.method == Method::dual) return {dual_distance(query), {}};
  const auto& a = std::get<geom::Shape>(query.a);
  const auto& b = std::get<geom::Shape>(query.b);
  const auto system = query.method == Method::newton8 ? geom::NewtonSystem::eight : geom::NewtonSystem::five;
  const geom::WitnessPair guess = query.seed(a, X_WA, b, X_WB);
  const geom::WitnessPair seed = geom::checked_seed(a, X_WA, b, X_WB, guess);
  if (seed.status != geom::SeedStatus::usable) return {{}, seed.status};
  return {geom::newton_distance(a, X_WA, b, X_WB, system, seed), {}};
}

std::string answer_json(const std::string& id, const DistanceAnswer& answer, const std::string& notice) {
  std::string text;
  text.reserve(400 + id.size());
  text += '{';
  text += id_json(id);
  append_distance(text, answer.result);
  if (answer.seed_status) text += fmt::format(",\"seed_status\":\"{}\"", geom::to_string(*answer.seed_status));
  if (!notice.empty()) text += fmt::format(",\"notice\":{}", nlohmann::json(notice).dump());
  return text + '}';
}

std::string error_json(const std::string& id, const std::string& message) {
  // A message quotes its line, which may be cut in the middle of a character.
  const std::string quoted = nlohmann::json(message).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return fmt::format("{{{}\"error\":{}}}", id_json(id), quoted);
}

Reply reply_to(std::string_view line, long number) {
  std::string id;
  try {
    return {reply_text(line, id), true};
  } catch (const InputError& error) {
    return {error_json(id, fmt::format("line {}: {}", number, error.what())), false};
  }
}

}  // namespace hardbody
