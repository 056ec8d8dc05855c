#include "run/observables_json.h"

#include "io/json_values.h"

#include <cmath>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

using Json = nlohmann::ordered_json;

Json estimate_json(const ed::Estimate& e, const MissingWords& words) {
  Json json = {{"value", number_json(e.value)}, {"error", number_json(e.error)}};
  if (!std::isfinite(e.value)) json["missing"] = missing_text(e.missing, words);
  return json;
}

Json matrix_json(const Eigen::Matrix3d& m) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({number_json(m(i, 0)), number_json(m(i, 1)), number_json(m(i, 2))});
  return rows;
}

/// Director with S, whose reason it has where it is missing.
Json director_json(const ed::Director& d, const ed::Estimate& S, const MissingWords& words) {
  if (!d.axis.allFinite()) return estimate_json(ed::Estimate::none(S.missing), words);
  return {{"value", list_json(d.axis)}, {"error", number_json(d.error)}};
}

/// Pressure tensor with Z, whose reason it has where it is missing.
Json tensor_json(const ed::TensorEstimate& P, const ed::Estimate& Z, const MissingWords& words) {
  if (!P.value.allFinite()) return estimate_json(ed::Estimate::none(Z.missing), words);
  return {{"value", matrix_json(P.value)}, {"error", matrix_json(P.error)}};
}

/// Returns the value of an observable; null if the part has none of that kind.
Json value_json(const Observable& observable, const Part& part, const MissingWords& words) {
  if (const auto* member = std::get_if<ed::Director ed::GroupResults::*>(&observable.value)) {
    return director_json(part.results.**member, part.results.S, words);
  }
  if (const auto* member = std::get_if<ed::TensorEstimate ed::Results::*>(&observable.value)) {
    return part.whole == nullptr ? Json(nullptr) : tensor_json(part.whole->**member, part.whole->Z, words);
  }
  if (is_per_axis(observable) && !observable.of_box && !part.body_axes) return nullptr;
  Json list = Json::array();
  for (const ed::Estimate& e : numbers_of(observable, part)) {
    if (is_number(observable) && is_absent(e)) return nullptr;
    list.push_back(estimate_json(e, words));
  }
  if (list.empty()) return nullptr;
  return is_list(observable) ? list : list[0];
}

}  // namespace

nlohmann::ordered_json observables_json(const Part& part, const MissingWords& words, Source source) {
  Json json;
  for (const Observable* observable : observables_by(&Places::summary)) {
    if (source == Source::frames && !observable->in_frames) continue;
    Json value = value_json(*observable, part, words);
    if (!value.is_null()) json[observable->key] = std::move(value);
  }
  return json;
}

}  // namespace hardbody
