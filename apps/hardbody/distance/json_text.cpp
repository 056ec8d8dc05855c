#include "distance/json_text.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <iterator>

namespace hardbody {

void append_number(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += "null";
  } else {
    char digits[32];
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }
}

void append_vector(std::string& text, const Eigen::Vector3d& v) {
  for (int k = 0; k < 3; ++k) {
    text += k == 0 ? '[' : ',';
    append_number(text, v[k]);
  }
  text += ']';
}

void append_member(std::string& text, std::string_view name, bool answered, const Eigen::Vector3d& v) {
  text += name;
  if (answered) {
    append_vector(text, v);
  } else {
    text += "null";
  }
}

void append_rows(std::string& text, const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  text += '[';
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    text += i == 0 ? "[" : ",[";
    for (Eigen::Index k = 0; k < rows.cols(); ++k) {
      if (k > 0) text += ',';
      append_number(text, rows(i, k));
    }
    text += ']';
  }
  text += ']';
}

void append_distance(std::string& text, const geom::DistanceResult& r) {
  const bool answered = r.status == geom::DistanceStatus::separated || r.status == geom::DistanceStatus::overlapping;
  text += "\"distance\":";
  append_number(text, r.distance);
  append_member(text, ",\"point_a\":", answered, r.point_a);
  append_member(text, ",\"point_b\":", answered, r.point_b);
  append_member(text, ",\"normal\":", answered, r.normal);
  fmt::format_to(std::back_inserter(text),
                 ",\"status\":\"{}\",\"iterations\":{},\"error_bound\":", geom::to_string(r.status), r.iterations);
  append_number(text, r.error_bound);
}

std::string id_json(const std::string& id) {
  return id.empty() ? "" : fmt::format("\"id\":{},", id);
}

}  // namespace hardbody
