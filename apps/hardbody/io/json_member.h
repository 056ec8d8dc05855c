#pragma once

/// Reading of JSON with messages that name the member, its value and what is accepted. Private to the sources that read
/// JSON, because it includes the parser.

#include "base/errors.h"

#include <geom/pose.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Text that is not JSON, or that is malformed on purpose: a duplicate key in one object, numbers beyond the range of a
/// double, deep nesting (which would exhaust the stack later). what(): "is ...", for a message that says where.
class JsonError : public std::runtime_error {
 public:
  explicit JsonError(const std::string& what, std::optional<std::size_t> byte = {})
      : std::runtime_error(what), offset(byte) {}
  std::optional<std::size_t> offset;  ///< byte at which the error was noticed, if known
};

/// Parses a text. Throws JsonError.
nlohmann::json parse_json(std::string_view text);

/// Member of a JSON document, with its name in messages. Refers to the document. Throws InputError with messages that
/// do not name the document: "a.shape.semi_axes is ...; accepted: ...".
struct JsonMember {
  const nlohmann::json* json;
  std::string name;  ///< name, a.shape.semi_axes; empty: the whole document

  bool has(const char* key) const { return json->is_object() && json->contains(key); }
  JsonMember at(const char* key, std::string_view accepted) const;

  /// Throws unless this is an object with no other keys.
  void allow(std::span<const std::string_view> keys) const;

  InputError bad(std::string_view accepted) const;

  bool boolean() const;
  double number() const;
  std::string text(std::string_view accepted) const;
  std::vector<double> numbers(std::size_t size, const char* accepted) const;
  Eigen::Vector3d vector() const;

  /// Returns make(); a std::invalid_argument of the library becomes a message about this member.
  template <class Make>
  auto checked(const Make& make) const {
    try {
      return make();
    } catch (const std::invalid_argument& error) {
      throw refused(error.what());
    }
  }

 private:
  std::string path_of(std::string_view key) const;
  InputError refused(std::string_view why) const;
};

/// Reads {"position": [x, y, z]}, within the range of a pose.
Eigen::Vector3d read_position(const JsonMember& body);
/// Reads [w, x, y, z]. A quaternion whose length differs from 1 by at most kQuaternionTolerance is normalised; if the
/// difference exceeds kJsonRounding, a line is added to `notices`.
geom::Pose read_orientation(const JsonMember& orientation, const Eigen::Vector3d& position,
                            std::vector<std::string>& notices);
/// Returns the line of `notices` for a quaternion of this length; `name`: that of the member.
std::string normalized_text(std::string_view name, double length);

}  // namespace hardbody
