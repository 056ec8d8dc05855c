#include "commands/commands.h"
#include "distance/query.h"
#include "distance/seeds.h"
#include "io/line_reader.h"
#include "io/orientation.h"

#include <geom/tolerances.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hardbody {
namespace {

constexpr std::size_t kLongestLine = 1 << 20;

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r\v\f") == std::string_view::npos;
}

Reply reply(const LineReader& lines) {
  if (!lines.too_long()) return reply_to(lines.line(), lines.number());
  return {error_json("", fmt::format("line {}: is too long; accepted: at most {} bytes", lines.number(), kLongestLine)),
          false};
}

/// Throws if output failed: after a full disk, or a closed pipe with SIGPIPE ignored, nothing more can be written.
void require_written(bool written) {
  if (!written) throw std::runtime_error(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
}

}  // namespace

std::string distance_help() {
  return fmt::format(
      R"(A line in:
  {{"a":{{"shape":{{"kind":"ellipsoid","semi_axes":[1,1,3]}},"position":[0,0,0],"orientation":[1,0,0,0]}},"b":{{..}}}}
  shape        or {{"kind":"superellipsoid","semi_axes":[a,b,c],"exponents":[e1,e2]}}, exponents {} to {}:
               (|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) <= 1
               or {{"kind":"sphere","radius":r}}
               or {{"kind":"capsule","half_length":l,"radius":r}}, along z
               or {{"kind":"box","half_extents":[a,b,c]}}
               or {{"kind":"polyhedron","vertices":[[x,y,z],..]}}, their hull, the origin inside
               or {{"kind":"polyhedron","solid":"cube"}}, any Platonic or Archimedean solid, of circumradius 1 or
               "circumradius":R
               or {{"kind":"cylinder","half_length":l,"radius":r}}, along z
               or {{"kind":"cone","height":h,"radius":r}}, along z, the base at "base":z, by default -h/4
               Kinds with edges may have "rounding":r, a ball swept over them
               or {{"kind":"half_space","normal":[x,y,z],"offset":d}}, by default z <= 0; one of the two bodies
  orientation  unit quaternion w, x, y, z from body to world; default: no rotation. A quaternion whose length differs
               from 1 by at most {:g} is normalized, with a notice in the answer if by more than {:g}
  method       "dual" (the default), or the paper's equations: "newton8", "newton5", for ellipsoids, superellipsoids and
               spheres
  seed         starting points of these two methods: {} (the default is the first)
  penetration  answer of the dual method for deep overlaps: "global" (the default), the shortest of all translations
               that separate the bodies, or "local", a stationary one, found 10 to 75 times faster for most smooth bodies
  id           any JSON, returned with the answer
  query        "distance" (the default), or one of these, without method and seed; "gradient" and "patch" take penetration:
    "gradient"         a, b: adds gradient and hessian of the distance by x = (dp_a, dtheta_a, dp_b, dtheta_b), small
                       moves and rotations in the world frame, normal_gradient, point_a_gradient, point_b_gradient
                       (three rows of 12), stiffness, and derivatives: "twice"; "once", "by_position", "none": those that do
                       not exist are null
    "patch"            a, b, "within":w (default 0), "tolerance":t (0.01), "max_points":n (8): adds the contact patch,
                       all points at which the bodies are within w of touching: kind "polygon", "segment", "point" or
                       "empty", area, centre, error, points with a, b, depth, id
    "overlap"          a, b: {{"overlap":"yes"}}, "no" or "unknown"
    "closest_point"    a, "point":[x,y,z]: distance (negative inside), point, normal, status, error_bound
    "contains"         a, point: {{"contains":true}}
    "ray"              a, "origin":[x,y,z], "direction":[x,y,z]: status "hit", "missed", "inside" or "not_converged"; t in
                       units of the direction, point, normal. "exit":true: the last point in the body
    "time_of_contact"  a, b, "t_max":t, "motion_a" and "motion_b":{{"velocity":[..],"angular_velocity":[..],"inertia":[..]}},
                       by default at rest, moments 1: status "hit", "separated", "overlapping", "budget_exhausted" or
                       "failed"; time, point, normal
A line out:
  {{"distance":..,"point_a":[..],"point_b":[..],"normal":[..],"status":"separated","iterations":..,"error_bound":..}}
  normal       unit, from a to b; point_b - point_a = distance * normal
  status       "separated"; "overlapping": distance is minus the penetration depth; "not_converged", "singular":
               no answer; the four members above are null
  error_bound  certified: distance <= true distance <= distance + error_bound; null if nothing is certified
  seed_status  "overlapping", "declined": only if the seed had no starting points
  notice       only if the length of a quaternion was not 1: names it and its length
An invalid line is answered by {{"error":"line 3: .."}}, blank lines are skipped.
Exit status: 0 every line was answered or declined, 1 the answers could not be written, 2 a line was invalid.)",
      geom::kMinExponent, geom::kMaxExponent, kQuaternionTolerance, kJsonRounding, built_in_seeds());
}

int distance(const std::string& path) {
  LineReader lines(path, kLongestLine);
  // A process that writes one line at a time waits for its answer.
  const bool flush = !lines.is_regular_file();
  bool all_good = true;
  while (lines.next()) {
    if (is_blank(lines.line()) && !lines.too_long()) continue;
    Reply answered = reply(lines);
    all_good = all_good && answered.good;
    answered.text += '\n';
    require_written(std::fwrite(answered.text.data(), 1, answered.text.size(), stdout) == answered.text.size());
    if (flush) require_written(std::fflush(stdout) == 0);
  }
  require_written(std::fflush(stdout) == 0);
  return all_good ? 0 : 2;
}

}  // namespace hardbody
