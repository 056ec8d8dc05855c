#pragma once

/// Lines with a "query" other than "distance". Private to the sources that read JSON, because it includes the parser.

#include "io/json_member.h"

#include <string>
#include <string_view>

namespace hardbody {

/// Names of all queries, in quotes, for messages.
inline constexpr const char* kQueries =
    "\"distance\", \"gradient\", \"patch\", \"overlap\", \"closest_point\", \"contains\", \"ray\", "
    "\"time_of_contact\"";

/// Returns the query of a line; "distance" without one. Throws InputError for other texts.
std::string query_name(const JsonMember& root);

/// Answers a line with the query of this name, which is not "distance", as one line without a line break. `id`: JSON
/// text of the line's id, or empty. Throws InputError, with a message that does not contain the line number.
std::string query_answer(std::string_view name, const JsonMember& root, const std::string& id);

}  // namespace hardbody
