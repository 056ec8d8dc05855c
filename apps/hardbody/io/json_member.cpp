#include "io/json_member.h"

#include "base/suggest.h"
#include "io/orientation.h"
#include "io/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace hardbody {
namespace {

/// Deeper than any meaningful document; far less than the recursion that json::dump supports.
constexpr int kDeepest = 100;
constexpr int kNumberOverflow = 406;

/// Returns a value as JSON on one line, shortened, for messages.
std::string shown(const nlohmann::json& value) {
  return one_line(value.dump(), kShownLength);
}

/// Parser callback that refuses duplicate names at any depth, of which json::parse would keep the last.
class StrictObjects {
 public:
  bool operator()(int depth, nlohmann::json::parse_event_t event, const nlohmann::json& parsed) {
    if (depth > kDeepest) throw JsonError(fmt::format("is nested more than {} deep", kDeepest));
    if (event == nlohmann::json::parse_event_t::object_start) keys_.emplace_back();
    if (event == nlohmann::json::parse_event_t::object_end) keys_.pop_back();
    if (event == nlohmann::json::parse_event_t::key && !keys_.back().insert(parsed.get<std::string>()).second) {
      throw JsonError(fmt::format("has the key {} twice in one object", shown(parsed)));
    }
    return true;
  }

 private:
  std::vector<std::set<std::string>> keys_;  ///< keys of the objects that are open
};

}  // namespace

nlohmann::json parse_json(std::string_view text) {
  StrictObjects strict;
  try {
    return nlohmann::json::parse(text, [&](int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
      return strict(depth, event, parsed);
    });
  } catch (const nlohmann::json::parse_error& error) {
    // The parser counts bytes from 1, plus one if it reached the end.
    throw JsonError("is not valid JSON", std::min(error.byte == 0 ? 0 : error.byte - 1, text.size()));
  } catch (const nlohmann::json::out_of_range& error) {
    throw JsonError(error.id == kNumberOverflow ? "has a number beyond the range of a double" : "is not valid JSON");
  }
}

std::string JsonMember::path_of(std::string_view key) const {
  std::string path;
  path.reserve(name.size() + 1 + key.size());
  if (!name.empty()) path.append(name).append(1, '.');
  return path.append(key);
}

JsonMember JsonMember::at(const char* key, std::string_view accepted) const {
  if (!has(key)) throw InputError(fmt::format("{} is missing; accepted: {}", path_of(key), accepted));
  return {&json->at(key), path_of(key)};
}

void JsonMember::allow(std::span<const std::string_view> keys) const {
  const auto accepted = [&] { return fmt::format("{}", fmt::join(keys, ", ")); };
  if (!json->is_object()) throw bad(fmt::format("an object with {}", accepted()));
  for (const auto& member : json->items()) {
    if (std::find(keys.begin(), keys.end(), member.key()) != keys.end()) continue;
    const std::optional<std::string> nearest = nearest_name(member.key(), keys);
    throw InputError(fmt::format("unknown key {}{}; accepted: {}", one_line(path_of(member.key()), kShownLength),
                                 nearest ? fmt::format(", did you mean {}?", path_of(*nearest)) : "", accepted()));
  }
}

InputError JsonMember::bad(std::string_view accepted) const {
  return InputError(
      fmt::format("{} is {}; accepted: {}", name.empty() ? "the top level" : name, shown(*json), accepted));
}

InputError JsonMember::refused(std::string_view why) const {
  // The library's messages also end with what is accepted.
  constexpr std::string_view kAccepted = "; accepted: ";
  const std::size_t cut = std::min(why.find(kAccepted), why.size());
  return InputError(fmt::format("{} is {} ({}){}", name, shown(*json), one_line(why.substr(0, cut)), why.substr(cut)));
}

bool JsonMember::boolean() const {
  if (!json->is_boolean()) throw bad("true, false");
  return json->get<bool>();
}

double JsonMember::number() const {
  if (!json->is_number() || !std::isfinite(json->get<double>())) throw bad("a finite number");
  return json->get<double>();
}

std::string JsonMember::text(std::string_view accepted) const {
  if (!json->is_string()) throw bad(accepted);
  return json->get<std::string>();
}

std::vector<double> JsonMember::numbers(std::size_t size, const char* accepted) const {
  const auto is_number = [](const auto& x) { return x.is_number() && std::isfinite(x.template get<double>()); };
  if (!json->is_array() || json->size() != size || !std::all_of(json->begin(), json->end(), is_number)) {
    throw bad(accepted);
  }
  return json->get<std::vector<double>>();
}

Eigen::Vector3d JsonMember::vector() const {
  const std::vector<double> v = numbers(3, "three finite numbers");
  return {v[0], v[1], v[2]};
}

Eigen::Vector3d read_position(const JsonMember& body) {
  const JsonMember position = body.at("position", "three finite numbers");
  const Eigen::Vector3d values = position.vector();
  return position.checked([&] { return geom::Pose::translation(values).position(); });
}

geom::Pose read_orientation(const JsonMember& orientation, const Eigen::Vector3d& position,
                            std::vector<std::string>& notices) {
  const std::vector<double> q = orientation.numbers(4, "a unit quaternion [w, x, y, z]");
  const JsonOrientation read = orientation.checked([&] { return read_quaternion({q[0], q[1], q[2], q[3]}, position); });
  if (read.normalized) notices.push_back(normalized_text(orientation.name, read.length));
  return read.pose;
}

std::string normalized_text(std::string_view name, double length) {
  constexpr double kShownBySix = 1e-5;  // difference from 1 that six digits show
  const int digits = std::abs(length - 1) > kShownBySix ? 6 : 9;
  return fmt::format("{} is a quaternion of length {:.{}g}: normalized", name, length, digits);
}

}  // namespace hardbody
