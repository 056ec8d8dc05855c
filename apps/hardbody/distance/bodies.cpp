#include "distance/bodies.h"

#include "io/json_shape.h"

#include <Eigen/Core>

#include <string_view>

namespace hardbody {

QueryBody read_body(const JsonMember& body, std::vector<std::string>& notices) {
  constexpr std::string_view kKeys[] = {"shape", "position", "orientation"};
  body.allow(kKeys);
  const JsonMember member = body.at("shape", "{\"kind\":\"ellipsoid\",\"semi_axes\":[a,b,c]}");
  const QueryShape shape =
      is_half_space(member) ? QueryShape(read_half_space(member)) : QueryShape(read_shape(member, ", \"half_space\""));
  const Eigen::Vector3d position = read_position(body);
  if (!body.has("orientation")) return {shape, geom::Pose::translation(position)};
  return {shape, read_orientation(body.at("orientation", ""), position, notices)};
}

}  // namespace hardbody
