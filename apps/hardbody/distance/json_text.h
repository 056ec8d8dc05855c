#pragma once

/// Answers of `hardbody distance` as text: numbers that read back as the same double.

#include <geom/distance.h>

#include <Eigen/Core>

#include <string>
#include <string_view>

namespace hardbody {

/// Appends a number with the fewest digits that give it again, or `null` if it is not finite.
void append_number(std::string& text, double value);

/// Appends [x, y, z], its numbers null if they are not finite.
void append_vector(std::string& text, const Eigen::Vector3d& v);

/// Appends name and vector; `null` instead of the vector if there is no answer. `name`: `,"point_a":`.
void append_member(std::string& text, std::string_view name, bool answered, const Eigen::Vector3d& v);

/// Appends [[..], ..], one list for each row.
void append_rows(std::string& text, const Eigen::Ref<const Eigen::MatrixXd>& rows);

/// Appends `"distance":..,"point_a":..,` and so on to `"error_bound":..`.
void append_distance(std::string& text, const geom::DistanceResult& result);

/// Returns `"id":..,` of the text of an id; nothing without one.
std::string id_json(const std::string& id);

}  // namespace hardbody
