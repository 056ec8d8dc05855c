#pragma once

/// Bodies and options of a query as JSON. Private to the sources that read JSON, because it includes the parser.

#include "distance/query.h"
#include "io/json_member.h"

#include <geom/pose.h>

#include <string>
#include <vector>

namespace hardbody {

struct QueryBody {
  QueryShape shape;
  geom::Pose pose;
};

/// Reads {"shape": .., "position": [..], "orientation": [..]}. Changes made to numbers are added to `notices`.
QueryBody read_body(const JsonMember& body, std::vector<std::string>& notices);

/// Reads "penetration" of a query; global if it is absent.
geom::Penetration read_penetration(const JsonMember& query);

}  // namespace hardbody
