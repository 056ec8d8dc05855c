#include "commands.h"
#include "distance_query.h"
#include "distance_seeds.h"
#include "errors.h"
#include "line_reader.h"

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

struct Reply {
  std::string line;
  bool good;
};

Reply reply_to(const LineReader& lines) {
  std::string id;
  try {
    if (lines.too_long()) throw InputError(fmt::format("is too long; accepted: at most {} bytes", kLongestLine));
    const DistanceQuery query = parse_query(lines.line(), id);
    return {answer_json(id, answer(query)) + '\n', true};
  } catch (const InputError& error) {
    return {error_json(id, fmt::format("line {}: {}", lines.number(), error.what())) + '\n', false};
  }
}

/// A full disk; a closed pipe, where SIGPIPE is ignored: there is no point in going on.
void require_written(bool written) {
  if (!written) throw std::runtime_error(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
}

}  // namespace

std::string distance_help() {
  return fmt::format(
      R"(A line in:
  {{"a":{{"shape":{{"kind":"ellipsoid","semi_axes":[1,1,3]}},"position":[0,0,0],"orientation":[1,0,0,0]}},"b":{{..}}}}
  orientation  unit quaternion w, x, y, z from body to world; without it the body is not turned
  method       "dual" (the default), or the paper's equations: "newton8", "newton5"
  seed         where these two start: {} (the default is the first)
  id           any JSON, comes back with the answer
A line out:
  {{"distance":..,"point_a":[..],"point_b":[..],"normal":[..],"status":"separated","iterations":..}}
  normal       unit, from a to b; point_b - point_a = distance * normal
  status       "separated"; "overlapping": distance is minus the penetration depth; "not_converged", "singular":
               no answer, null instead of the four above
  seed_status  "overlapping", "declined": only if the seed had no points to start from
A bad line is answered by {{"error":"line 3: .."}}, blank lines are skipped.
Exit status: 0 every line was answered or declined, 2 a line was bad, 1 the answers could not be written.)",
      built_in_seeds());
}

int distance(const std::string& path) {
  LineReader lines(path, kLongestLine);
  // Whoever writes one line at a time waits for its answer.
  const bool flush = !lines.is_regular_file();
  bool all_good = true;
  while (lines.next()) {
    if (is_blank(lines.line()) && !lines.too_long()) continue;
    const Reply reply = reply_to(lines);
    all_good = all_good && reply.good;
    require_written(std::fwrite(reply.line.data(), 1, reply.line.size(), stdout) == reply.line.size());
    if (flush) require_written(std::fflush(stdout) == 0);
  }
  require_written(std::fflush(stdout) == 0);
  return all_good ? 0 : 2;
}

}  // namespace hardbody
