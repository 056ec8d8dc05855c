#include "distance/queries.h"

#include "base/errors.h"
#include "distance/bodies.h"
#include "distance/json_text.h"
#include "distance/query.h"

#include <ed/time_of_contact.h>

#include <geom/contact_patch.h>
#include <geom/derivatives.h>
#include <geom/half_space.h>
#include <geom/kernel/any_body.h>
#include <geom/queries.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Vector3d;
using geom::HalfSpace;
using geom::Shape;

/// Line that is read and answered: its members, and what the answer begins and ends with.
class Line {
 public:
  Line(const JsonMember& root, const std::string& id) : root_(root), answer_("{" + id_json(id)) {}

  QueryBody body(const char* name) { return read_body(root_.at(name, "a body"), notices_); }
  Vector3d vector(const char* name) const { return root_.at(name, "[x,y,z]").vector(); }
  const JsonMember& root() const { return root_; }
  std::string& answer() { return answer_; }

  std::string ended() {
    if (!notices_.empty()) {
      answer_ += fmt::format(",\"notice\":{}", nlohmann::json(fmt::format("{}", fmt::join(notices_, "; "))).dump());
    }
    return std::move(answer_) + '}';
  }

 private:
  const JsonMember& root_;
  std::vector<std::string> notices_;
  std::string answer_;
};

void allow(const JsonMember& root, std::initializer_list<std::string_view> keys) {
  root.allow(std::span(keys.begin(), keys.size()));
}

/// Returns f(a, b) of two shapes, of which one may be a half-space.
template <class F>
auto with_pair(const QueryBody& a, const QueryBody& b, const F& f) {
  const auto* plane_a = std::get_if<HalfSpace>(&a.shape);
  const auto* plane_b = std::get_if<HalfSpace>(&b.shape);
  if (plane_a != nullptr && plane_b != nullptr) {
    throw InputError("a.shape and b.shape are half-spaces; accepted: one at the most");
  }
  const auto* s = std::get_if<Shape>(&a.shape);
  const auto* t = std::get_if<Shape>(&b.shape);
  if (plane_a != nullptr) return geom::kernel::with_body(*t, [&](const auto& body) { return f(*plane_a, body); });
  if (plane_b != nullptr) return geom::kernel::with_body(*s, [&](const auto& body) { return f(body, *plane_b); });
  return f(*s, *t);
}

/// Returns the member `name` of a line, one of two bodies; its shape has an end.
const Shape& finite_shape(const QueryBody& body, const char* name) {
  const auto* shape = std::get_if<Shape>(&body.shape);
  if (shape != nullptr) return *shape;
  throw InputError(fmt::format("{}.shape is a half-space; accepted: for this query any other shape", name));
}

void append_numbers(std::string& text, std::string_view name, const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  text += name;
  if (rows.array().isNaN().all()) {
    text += "null";
  } else {
    append_rows(text, rows);
  }
}

std::string gradient(Line& line) {
  allow(line.root(), {"query", "a", "b", "penetration", "id"});
  const QueryBody a = line.body("a");
  const QueryBody b = line.body("b");
  const geom::DistanceOptions options{.penetration = read_penetration(line.root())};
  geom::DistanceResult at;
  const geom::DistanceDerivatives d = with_pair(a, b, [&](const auto& s, const auto& t) {
    return geom::distance_derivatives(s, a.pose, t, b.pose, options, &at);
  });
  std::string& text = line.answer();
  append_distance(text, at);
  // The gradient has numbers where the rest has none, and may have some itself.
  text += ",\"gradient\":[";
  for (int k = 0; k < d.gradient.size(); ++k) {
    if (k > 0) text += ',';
    append_number(text, d.gradient[k]);
  }
  text += ']';
  append_numbers(text, ",\"hessian\":", d.hessian);
  append_numbers(text, ",\"normal_gradient\":", d.normal);
  append_numbers(text, ",\"point_a_gradient\":", d.point_a);
  append_numbers(text, ",\"point_b_gradient\":", d.point_b);
  text += ",\"stiffness\":";
  append_number(text, d.stiffness);
  text += fmt::format(",\"derivatives\":\"{}\"", geom::to_string(d.status));
  return line.ended();
}

geom::PatchOptions patch_options(const JsonMember& query) {
  geom::PatchOptions options;
  const auto read = [&](const char* key, double usual, double least, double most, const char* accepted) {
    if (!query.has(key)) return usual;
    const JsonMember member = query.at(key, accepted);
    const double value = member.number();
    if (!(value >= least && value <= most)) throw member.bad(accepted);
    return value;
  };
  options.within = read("within", options.within, 0, geom::kMaxCoordinate, "a length, 0 to 1e100");
  options.tolerance = read("tolerance", options.tolerance, 1e-4, 0.5, "1e-4 to 0.5");
  constexpr const char* kPoints = "a whole number, 3 to 10000";
  const double points = read("max_points", options.max_points, 3, 10000, kPoints);
  if (points != std::floor(points)) throw query.at("max_points", kPoints).bad(kPoints);
  options.max_points = static_cast<int>(points);
  return options;
}

std::string patch(Line& line) {
  allow(line.root(), {"query", "a", "b", "within", "tolerance", "max_points", "penetration", "id"});
  const QueryBody a = line.body("a");
  const QueryBody b = line.body("b");
  const geom::PatchOptions options = patch_options(line.root());
  const geom::Penetration penetration = read_penetration(line.root());
  geom::DistanceResult at;
  const geom::ContactPatch found = with_pair(a, b, [&](const auto& s, const auto& t) {
    at = distance(s, a.pose, t, b.pose, {.penetration = penetration});
    return geom::contact_patch(s, a.pose, t, b.pose, at, options);
  });
  std::string& text = line.answer();
  append_distance(text, at);
  text += fmt::format(",\"patch\":{{\"kind\":\"{}\",\"area\":", geom::to_string(found.kind));
  append_number(text, found.area);
  append_member(text, ",\"centre\":", found.kind != geom::PatchKind::empty, found.centre);
  text += ",\"error\":";
  append_number(text, found.error);
  text += ",\"points\":[";
  for (const geom::PatchPoint& point : found.points) {
    if (&point != found.points.data()) text += ',';
    append_member(text, "{\"a\":", true, point.point_a);
    append_member(text, ",\"b\":", true, point.point_b);
    text += ",\"depth\":";
    append_number(text, point.depth);
    text += fmt::format(",\"id\":\"{:x}\"}}", point.id);  // JSON's numbers have 53 bits
  }
  text += "]}";
  return line.ended();
}

std::string overlap(Line& line) {
  allow(line.root(), {"query", "a", "b", "id"});
  const QueryBody a = line.body("a");
  const QueryBody b = line.body("b");
  const geom::Answer answer =
      with_pair(a, b, [&](const auto& s, const auto& t) { return geom::overlap(s, a.pose, t, b.pose); });
  line.answer() += fmt::format("\"overlap\":\"{}\"", geom::to_string(answer));
  return line.ended();
}

std::string closest_point(Line& line) {
  allow(line.root(), {"query", "a", "point", "id"});
  const QueryBody a = line.body("a");
  const Vector3d point = line.vector("point");
  const geom::ClosestPoint closest =
      std::visit([&](const auto& shape) { return geom::closest_point(shape, a.pose, point); }, a.shape);
  const bool answered = !std::isnan(closest.distance);
  std::string& text = line.answer();
  text += "\"distance\":";
  append_number(text, closest.distance);
  append_member(text, ",\"point\":", answered, closest.point);
  append_member(text, ",\"normal\":", answered, closest.normal);
  text += fmt::format(",\"status\":\"{}\",\"error_bound\":", geom::to_string(closest.status));
  append_number(text, closest.error_bound);
  return line.ended();
}

std::string contains(Line& line) {
  allow(line.root(), {"query", "a", "point", "id"});
  const QueryBody a = line.body("a");
  const Vector3d point = line.vector("point");
  const auto* plane = std::get_if<HalfSpace>(&a.shape);
  const bool inside = plane != nullptr ? plane->contains(a.pose.to_body(point))
                                       : geom::contains(std::get<Shape>(a.shape), a.pose, point);
  line.answer() += fmt::format("\"contains\":{}", inside);
  return line.ended();
}

std::string ray(Line& line) {
  allow(line.root(), {"query", "a", "origin", "direction", "exit", "id"});
  const QueryBody a = line.body("a");
  const Vector3d origin = line.vector("origin");
  const Vector3d direction = line.vector("direction");
  if (direction.isZero(0)) throw InputError("direction is [0,0,0]; accepted: a vector of any other length");
  const bool exit = line.root().has("exit") && line.root().at("exit", "").boolean();
  const geom::RayHit hit =
      exit ? geom::ray_exit(finite_shape(a, "a"), a.pose, origin, direction)
           : std::visit([&](const auto& shape) { return geom::ray_cast(shape, a.pose, origin, direction); }, a.shape);
  const bool answered = !std::isnan(hit.t);
  std::string& text = line.answer();
  text += fmt::format("\"status\":\"{}\",\"t\":", geom::to_string(hit.status));
  append_number(text, hit.t);
  append_member(text, ",\"point\":", answered, hit.point);
  append_member(text, ",\"normal\":", answered, hit.normal);
  return line.ended();
}

ed::Motion motion(const JsonMember& root, const char* name, const geom::Pose& pose) {
  constexpr std::string_view kKeys[] = {"velocity", "angular_velocity", "inertia"};
  ed::Motion motion{.pose = pose};
  if (!root.has(name)) return motion;
  const JsonMember member = root.at(name, "");
  member.allow(kKeys);
  if (member.has("velocity")) motion.velocity = member.at("velocity", "").vector();
  if (member.has("angular_velocity")) motion.angular_velocity = member.at("angular_velocity", "").vector();
  if (member.has("inertia")) motion.inertia = member.at("inertia", "").vector();
  return motion;
}

std::string time_of_contact(Line& line) {
  allow(line.root(), {"query", "a", "b", "motion_a", "motion_b", "t_max", "id"});
  const QueryBody a = line.body("a");
  const QueryBody b = line.body("b");
  const auto in_motion = [](const Shape& shape) {
    return std::visit([](const auto& s) { return ed::BodyShape(s); }, shape);
  };
  const ed::BodyShape s = in_motion(finite_shape(a, "a"));
  const ed::BodyShape t = in_motion(finite_shape(b, "b"));
  const double t_max = line.root().at("t_max", "a time, 0 or more").number();
  const ed::Motion of_a = motion(line.root(), "motion_a", a.pose);
  const ed::Motion of_b = motion(line.root(), "motion_b", b.pose);
  const ed::ContactResult found = [&] {
    try {
      return ed::time_of_contact(s, of_a, t, of_b, t_max);
    } catch (const std::invalid_argument& error) {
      throw InputError(error.what());
    }
  }();
  const bool hit = found.status == ed::ContactStatus::hit;
  std::string& text = line.answer();
  text += fmt::format("\"status\":\"{}\",\"time\":", ed::to_string(found.status));
  append_number(text, found.time);
  append_member(text, ",\"point\":", hit, found.point);
  append_member(text, ",\"normal\":", hit, found.normal);
  text += fmt::format(",\"evaluations\":{}", found.evaluations);
  return line.ended();
}

struct NamedQuery {
  std::string_view name;
  std::string (*answer)(Line& line);
};
constexpr NamedQuery kNamedQueries[] = {
    {"gradient", gradient},
    {"patch", patch},
    {"overlap", overlap},
    {"closest_point", closest_point},
    {"contains", contains},
    {"ray", ray},
    {"time_of_contact", time_of_contact},
};

}  // namespace

std::string query_name(const JsonMember& root) {
  if (!root.has("query")) return "distance";
  const JsonMember member = root.at("query", kQueries);
  std::string name = member.text(kQueries);
  if (name == "distance") return name;
  for (const NamedQuery& query : kNamedQueries) {
    if (query.name == name) return name;
  }
  throw member.bad(kQueries);
}

std::string query_answer(std::string_view name, const JsonMember& root, const std::string& id) {
  for (const NamedQuery& query : kNamedQueries) {
    if (query.name != name) continue;
    Line line(root, id);
    return query.answer(line);
  }
  throw std::logic_error(fmt::format("no query {}", name));
}

}  // namespace hardbody
