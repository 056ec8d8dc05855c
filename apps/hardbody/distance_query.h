#pragma once

#include "distance_seeds.h"

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/newton.h>
#include <geom/pose.h>

#include <optional>
#include <string>
#include <string_view>

namespace hardbody {

/// What one line of `hardbody distance` asks.
struct DistanceQuery {
  geom::Ellipsoid a, b;
  geom::Pose X_WA, X_WB;
  std::optional<geom::NewtonSystem> newton;  ///< the paper's equations; nothing: the dual method
  SeedFunction seed;                         ///< for `newton`
};

struct DistanceAnswer {
  geom::DistanceResult result;
  std::optional<geom::SeedStatus> seed_status;  ///< set if the seed had no points to start from
};

/// Of one line, `{"a":{"shape":{..},"position":[..],"orientation":[..]},"b":{..},"method":..,"seed":..,"id":..}`: see
/// distance_help(). The JSON text of "id" goes to `id` even if the rest of the line is bad. Throws InputError, with a
/// message that does not say which line.
DistanceQuery parse_query(std::string_view line, std::string& id);

/// Never throws: what no method answers is declined.
DistanceAnswer answer(const DistanceQuery& query);

/// {"distance":..,..}, without a line break. Numbers with 17 significant digits, so that they read back as the same
/// double; a declined answer's are null.
std::string answer_json(const std::string& id, const DistanceAnswer& answer);

/// {"error":".."}
std::string error_json(const std::string& id, const std::string& message);

}  // namespace hardbody
