#pragma once

#include "distance/seeds.h"

#include <geom/any_shape.h>
#include <geom/distance.h>
#include <geom/half_space.h>
#include <geom/newton.h>
#include <geom/pose.h>

#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace hardbody {

enum class Method {
  dual,
  newton8,  ///< the paper's equations
  newton5,
};

/// Shape of a body in a query.
using QueryShape = std::variant<geom::Shape, geom::HalfSpace>;

/// Query in one line of `hardbody distance`.
struct DistanceQuery {
  QueryShape a, b;  ///< one half-space at the most
  geom::Pose X_WA, X_WB;
  Method method;
  SeedFunction seed;              ///< seed of the paper's equations
  geom::Penetration penetration;  ///< treatment of overlaps by the dual method
  std::string notice;             ///< changes made to the numbers of the query; empty: none
};

struct DistanceAnswer {
  geom::DistanceResult result;
  std::optional<geom::SeedStatus> seed_status;  ///< status of the seed if it had no starting points
};

/// Parses one line with the query "distance",
/// `{"a":{"shape":{..},"position":[..],"orientation":[..]},"b":{..},"method":..,"seed":..,"id":..}`: see
/// distance_help(). The JSON text of "id" is stored in `id` even if the rest of the line is invalid. Throws InputError,
/// with a message that does not contain the line number.
///
/// There are two readers: scan_query for lines of the usual form, and a JSON library for all others. Both give the same
/// result for lines that both can read.
DistanceQuery parse_query(std::string_view line, std::string& id);

/// Answers a query. Never throws: a query that no method answers is declined.
DistanceAnswer answer(const DistanceQuery& query);

/// Returns {"distance":..,..}, without a line break. Numbers have 17 significant digits, so that they read back as the
/// same double; numbers of a declined answer are null, and so is an infinite error bound. `notice`: that of the query.
std::string answer_json(const std::string& id, const DistanceAnswer& answer, const std::string& notice = "");

/// Returns {"error":".."}.
std::string error_json(const std::string& id, const std::string& message);

struct Reply {
  std::string text;  ///< one line, without a line break
  bool good;         ///< true: answered or declined; false: an error
};

/// Parses and answers one line, the `number`th. Never throws because of the line's content.
Reply reply_to(std::string_view line, long number);

}  // namespace hardbody
