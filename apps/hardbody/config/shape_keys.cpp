// Keys of the shapes in [shape] and [[species]], of all kinds; which kind has which is in shape_forms.cpp.

#include "base/shapes.h"
#include "base/suggest.h"
#include "config/keys.h"
#include "config/rules.h"
#include "config/shape_forms.h"

#include <ed/shape.h>
#include <ed/tolerances.h>

#include <geom/polyhedron.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Vector3d;

constexpr double kThinnest = 1e-2;      ///< least ratio of two semi-axes or edges; the largest is the inverse
constexpr double kShortestAxis = 1e-3;  ///< length where lengths are taken literally; the longest is the inverse
constexpr std::size_t kMostCorners = 1000;
constexpr double kFarthestCorner = 1e50;  ///< coordinate where only ratios count, within geom::kMaxSemiAxis

constexpr Range kRatios = {kThinnest, 1 / kThinnest};
constexpr const char* kRatioMeaning = "X0 = a/b, a along the axis of revolution";
constexpr const char* kExponentsComment =
    "[e1, e2], of the profile along z and of the section across it: 1 an\n"
    "ellipsoid, towards 0.25 a box, towards 1.6 an octahedron. The superball\n"
    "|x|^p + |y|^p + |z|^p = a^p has a = b = c and e1 = e2 = 2/p";

/// Takes three positive lengths; `what` they are in messages.
Taken take_three(const Value& value, const Place& at, const char* what, Vector3d& lengths) {
  if (!take_positive(value, lengths)) return Refusal{"three positive finite numbers [a, b, c]"};
  if (!(lengths.minCoeff() >= kThinnest * lengths.maxCoeff())) {
    return Refusal{fmt::format("{} of which none is more than {:g} times another", what, 1 / kThinnest)};
  }
  if (at.config.mixture && !(lengths.minCoeff() >= kShortestAxis && lengths.maxCoeff() <= 1 / kShortestAxis)) {
    return Refusal{fmt::format("{} from {:g} to {:g}", what, kShortestAxis, 1 / kShortestAxis)};
  }
  return std::nullopt;
}

Taken take_semi_axes(const Value& value, const Place& at, std::optional<Vector3d>& result) {
  return take_three(value, at, "semi-axes", result.emplace());
}

Taken take_edges(const Value& value, const Place& at, std::optional<Vector3d>& result) {
  return take_three(value, at, "edges", result.emplace());
}

Taken take_exponents(const Value& value, const Place& /*at*/, Eigen::Vector2d& result) {
  if (take_positive(value, result) && result.minCoeff() >= ed::kMinExponentInMotion &&
      result.maxCoeff() <= ed::kMaxExponentInMotion) {
    return std::nullopt;
  }
  return Refusal{
      fmt::format("two numbers [e1, e2], each from {:g} to {:g}", ed::kMinExponentInMotion, ed::kMaxExponentInMotion)};
}

/// Range of lengths: of a mixture they are literal, else only their ratios count.
Range lengths_of(const Place& at) {
  const double shortest = at.config.mixture ? kShortestAxis : 1 / kFarthestCorner;
  return {shortest, 1 / shortest};
}

Taken take_diameter(const Value& value, const Place& at, std::optional<double>& result) {
  return take_number(value, lengths_of(at), "", result.emplace());
}

Taken take_length(const Value& value, const Place& at, std::optional<double>& result) {
  const bool caps = at.species->shape.kind == ShapeKind::capsule;
  return take_number(value, {0, lengths_of(at).most}, caps ? "between the centres of the caps" : "of the body",
                     result.emplace());
}

Taken take_rounding(const Value& value, const Place& at, double& result) {
  return take_number(value, {0, lengths_of(at).most}, "radius of a ball that is swept over the body", result);
}

Taken take_vertices(const Value& value, const Place& at, std::optional<std::vector<Vector3d>>& result) {
  const std::string accepted = fmt::format("4 to {} points [x, y, z] of finite coordinates", kMostCorners);
  if (value.kind != Value::Kind::array || value.items.size() < 4 || value.items.size() > kMostCorners) {
    return Refusal{accepted};
  }
  std::vector<Vector3d>& points = result.emplace();
  const double furthest = lengths_of(at).most;
  for (std::size_t k = 0; k < value.items.size(); ++k) {
    const Value& item = value.items[k];
    const bool good = item.kind == Value::Kind::array && item.items.size() == 3 &&
                      std::all_of(item.items.begin(), item.items.end(), [](const Value& x) { return is_number(x); });
    if (!good) return Refusal{accepted, fmt::format(", whose point {} is {}", k + 1, item.shown)};
    points.emplace_back(item.items[0].real, item.items[1].real, item.items[2].real);
    if (points.back().cwiseAbs().maxCoeff() <= furthest) continue;
    return Refusal{fmt::format("coordinates up to {:g}", furthest),
                   fmt::format(", whose point {} is {}", k + 1, item.shown)};
  }
  return std::nullopt;
}

Taken take_solid(const Value& value, const Place& /*at*/, std::optional<std::string>& result) {
  const auto names = geom::solid_names();
  result = value.text;
  std::replace_if(
      result->begin(), result->end(), [](char c) { return c == '_' || c == '-'; }, ' ');
  if (value.kind == Value::Kind::text && std::find(names.begin(), names.end(), *result) != names.end()) {
    return std::nullopt;
  }
  const auto nearest = value.kind == Value::Kind::text ? nearest_name(*result, names) : std::nullopt;
  return Refusal{fmt::format("{}", fmt::join(names, ", ")),
                 nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : ""};
}

constexpr auto with_exponents = [](const Place& at) { return form_of(at.species->shape.kind).has("exponents"); };
constexpr auto with_rounding = [](const Place& at) { return form_of(at.species->shape.kind).has("rounding"); };

std::string kind_comment(const Place& /*at*/) {
  std::string names;
  for (const ShapeKind kind : kShapeKinds) {
    const char* between = kind == kShapeKinds.front() ? "" : kind == kShapeKinds.back() ? "\nor " : ", ";
    names += fmt::format("{}\"{}\"", between, to_string(kind));
  }
  return names;
}

constexpr const char* kOnlyRatios = "in any unit: only their ratios count;\n";

std::string axes_comment(const Place& at) {
  if (at.config.mixture) return "[a, b, c], as they are";
  const Vector3d used = ed::half_extents(at.species->body.shape);
  const bool last = has_equivalent_axes(at.species->shape.kind) && at.species->shape.true_aspect_ratio();
  return fmt::format("{}in use, l = 1{}: {:.6g}, {:.6g}, {:.6g}", kOnlyRatios,
                     last ? " and the axis of revolution last" : "", used.x(), used.y(), used.z());
}

std::string ratio_comment(const Place& at) {
  return std::string("X0 = a/b, a along the axis of revolution, from 0.01 to 100;\nor semi_axes") +
         (at.config.mixture ? "; (a b c)^(1/3) = 1 then" : " = [a, b, c], in any unit: only their ratios count");
}

std::string length_comment(const Place& at) {
  return at.species->shape.kind == ShapeKind::capsule ? "between the centres of the caps" : "of the body, along z";
}

/// Returns the comment of a key that gives lengths of other kinds; `first`: what the key is.
Comment lengths_comment(const char* first) {
  return [first](const Place& at) -> std::string {
    if (at.config.mixture) return first;
    return fmt::format("{}, in any unit: only ratios count;\nin use, l = 1: {}", first,
                       form_of(at.species->shape.kind).lengths(at.species->body.shape));
  };
}

}  // namespace

std::vector<Key> form_keys(const std::string& section) {
  const auto name = [&](const char* key) { return fmt::format("{}.{}", section, key); };
  const bool species = section == "species";
  return {
      {name("kind"), species ? "" : "\"ellipsoid\"",
       choice(&ShapeConfig::kind, std::vector(kShapeKinds.begin(), kShapeKinds.end())), kind_comment},
      {name("aspect_ratio"), "", number(&ShapeConfig::aspect_ratio, kRatios, kRatioMeaning), ratio_comment},
      {name("semi_axes"), "", bound(&ShapeConfig::semi_axes, take_semi_axes), axes_comment},
      {name("exponents"), "", bound(&ShapeConfig::exponents, take_exponents), kExponentsComment, with_exponents},
      {name("length"), "", bound(&ShapeConfig::length, take_length), length_comment},
      {name("diameter"), "", bound(&ShapeConfig::diameter, take_diameter),
       lengths_comment("of the body; of a cone, of its base")},
      {name("edges"), "", bound(&ShapeConfig::edges, take_edges), lengths_comment("[a, b, c] along body x, y, z")},
      {name("vertices"), "", bound(&ShapeConfig::vertices, take_vertices), lengths_comment("corners, in any frame")},
      {name("solid"), "", bound(&ShapeConfig::solid, take_solid),
       "Platonic or Archimedean solid, of circumradius 1; or vertices"},
      {name("rounding"), "0", bound(&ShapeConfig::rounding, take_rounding),
       "radius of a ball that is swept over the body, in the unit of its\nlengths (of a solid: its circumradius)",
       with_rounding},
  };
}

}  // namespace hardbody
