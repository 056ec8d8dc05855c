#pragma once

#include "distance/seeds.h"

#include <geom/any_shape.h>
#include <geom/distance.h>
#include <geom/newton.h>
#include <geom/pose.h>

#include <optional>
#include <string>
#include <string_view>

namespace hardbody {

enum class Method {
  dual,
  newton8,  ///< the paper's equations
  newton5,
};

/// What one line of `hardbody distance` asks.
struct DistanceQuery {
  geom::Shape a, b;
  geom::Pose X_WA, X_WB;
  Method method;
  SeedFunction seed;              ///< for the paper's equations
  geom::Penetration penetration;  ///< for the dual method
  std::string notice;             ///< what was done with its numbers; empty: nothing
};

struct DistanceAnswer {
  geom::DistanceResult result;
  std::optional<geom::SeedStatus> seed_status;  ///< set if the seed had no points to start from
};

/// Of one line, `{"a":{"shape":{..},"position":[..],"orientation":[..]},"b":{..},"method":..,"seed":..,"id":..}`: see
/// distance_help(). The JSON text of "id" goes to `id` even if the rest of the line is bad. Throws InputError, with a
/// message that does not say which line.
///
/// Two readers: scan_query for lines that are as nearly all are, and a JSON library for the others. What both read they
/// read alike.
DistanceQuery parse_query(std::string_view line, std::string& id);

/// Never throws: what no method answers is declined.
DistanceAnswer answer(const DistanceQuery& query);

/// {"distance":..,..}, without a line break. Numbers with 17 significant digits, so that they read back as the same
/// double; a declined answer's are null, and so is an infinite error bound. `notice`: of the query.
std::string answer_json(const std::string& id, const DistanceAnswer& answer, const std::string& notice = "");

/// {"error":".."}
std::string error_json(const std::string& id, const std::string& message);

struct Reply {
  std::string text;  ///< one line, without a line break
  bool good;         ///< answered or declined; false: an error
};

/// All of the above for one line, the `number`th. Never throws on account of the line.
Reply reply_to(std::string_view line, long number);

}  // namespace hardbody
