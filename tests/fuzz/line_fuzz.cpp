/// libFuzzer: lines of `hardbody distance`.
///
/// Whatever the line, the reply is one line of JSON: an error, or an answer whose numbers are finite or null. Both
/// readers read alike what both can read: the reply to the same line with a blank that only the slow one takes.

#include "base/errors.h"
#include "distance/query.h"
#include "distance/scanner.h"
#include "fuzz/fuzz_input.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>
#include <variant>

namespace {

using nlohmann::json;

void require(bool holds, const char* what, const std::string& reply) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n%s\n", what, reply.c_str());
  std::abort();
}

bool is_answer(const json& reply) {
  return reply.contains("status") && (reply["status"] == "separated" || reply["status"] == "overlapping");
}

void check(const hardbody::Reply& reply) {
  require(reply.text.find('\n') == std::string::npos, "a reply is one line", reply.text);
  // Throws on nan and inf, which are no JSON.
  const json parsed = json::parse(reply.text);
  require(reply.good == !parsed.contains("error"), "a bad line gets an error", reply.text);
  if (!reply.good) return;
  require(parsed["distance"].is_number() == is_answer(parsed), "an answer has a distance", reply.text);
  for (const char* key : {"point_a", "point_b", "normal"}) {
    require(parsed[key].is_array() == is_answer(parsed), "an answer has points and a normal", reply.text);
    for (const json& x : parsed[key]) require(x.is_number(), "an answer has finite numbers", reply.text);
  }
}

/// Whether the answer takes long, which only one in 64 of such lines may.
bool is_slow(const std::string& line) {
  try {
    std::string id;
    const hardbody::DistanceQuery query = hardbody::parse_query(line, id);
    const auto* a = std::get_if<geom::Shape>(&query.a);
    const auto* b = std::get_if<geom::Shape>(&query.b);
    if (a == nullptr || b == nullptr) return false;
    return !fuzz::are_quick(*a, query.X_WA, *b, query.X_WB) && std::hash<std::string>()(line) % 64 != 0;
  } catch (const hardbody::InputError&) {
    return false;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string line(reinterpret_cast<const char*>(data), size);
  if (line.find('\n') != std::string::npos || is_slow(line)) return 0;
  const hardbody::Reply reply = hardbody::reply_to(line, 1);
  check(reply);
  if (hardbody::scan_query(line)) {
    const json parsed = json::parse(line);  // what the fast reader takes is JSON
    // The id spelt with an escape, which the fast reader leaves to the other one.
    json spelt = parsed;
    spelt["id"] = "\x01";
    json slow = json::parse(hardbody::reply_to(spelt.dump(), 1).text);
    json fast = json::parse(reply.text);
    slow.erase("id");
    fast.erase("id");
    require(slow == fast, "both readers read alike", reply.text + '\n' + slow.dump());
  }
  return 0;
}
