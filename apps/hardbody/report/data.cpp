#include "report/page.h"

#include "base/escape.h"
#include "base/number_text.h"
#include "base/version.h"
#include "io/json_values.h"
#include "registry/curves.h"
#include "registry/key_names.h"
#include "registry/observables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <utility>

namespace hardbody {
namespace {

using Json = nlohmann::ordered_json;

/// Digits of a point of a curve: more than any plot or error bar shows. Averages of blocks keep all digits, because the
/// drift of the energy is visible only in the last ones.
constexpr int kCurveDigits = 9;
constexpr int kErrorDigits = 4;
constexpr int kAllDigits = 17;

/// Amount of data kept of a run; slim: of one of hundreds only what its plots show.
enum class Detail { full, slim };

/// Maximum number of bytes of all of a sweep's points together; points beyond are left to reports of their own.
constexpr std::size_t kMostOfPoints = 40'000'000;

Json rounded(double x, int digits = kCurveDigits) {
  if (!std::isfinite(x)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", x, digits).c_str(), nullptr);
}

/// Returns the bytes, little-endian like every machine that this program runs on.
template <class T>
std::string packed(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return base64(bytes);
}

/// Returns a column in single precision, as base64; a gap is a NaN.
Json packed_column(const std::vector<double>& values) {
  std::vector<float> singles(values.size());
  std::transform(values.begin(), values.end(), singles.begin(), [](double x) { return static_cast<float>(x); });
  return packed(singles);
}

Json full_column(const std::vector<double>& values, int digits) {
  Json list = Json::array();
  for (const double x : values) list.push_back(rounded(x, digits));
  return list;
}

/// Returns whether a column of blocks.csv is drawn.
bool is_drawn(const std::string& name) {
  return std::any_of(block_columns().begin(), block_columns().end(),
                     [&](const BlockColumn& c) { return c.name == name && c.in_reports; });
}

Json curves_json(const Curves& curves, Detail detail) {
  Json columns = Json::array();
  Json data = Json::array();
  const bool blocks = curves.name == "blocks";
  for (std::size_t k = 0; k < curves.columns.size(); ++k) {
    const std::string name = Curves::bare_name(curves.columns[k]);
    if (blocks && !is_drawn(name)) continue;
    columns.push_back({{"name", name}, {"unit", Curves::unit(curves.columns[k])}});
    if (blocks) {
      data.push_back(full_column(curves.values[k], kAllDigits));
    } else if (detail == Detail::slim) {
      data.push_back(packed_column(curves.values[k]));
    } else {
      data.push_back(full_column(curves.values[k], name.ends_with("_error") ? kErrorDigits : kCurveDigits));
    }
  }
  return {{"columns", std::move(columns)}, {"data", std::move(data)}};
}

Json polytopes_json(const View& view) {
  Json list = Json::array();
  for (const SweptPolytope& form : view.polytopes) {
    Json vertices = Json::array();
    for (const Eigen::Vector3d& x : form.vertices) vertices.push_back({rounded(x.x()), rounded(x.y()), rounded(x.z())});
    list.push_back({{"vertices", std::move(vertices)}, {"faces", form.faces}, {"rounding", rounded(form.rounding)}});
  }
  return list;
}

Json view_json(const View& view) {
  Json shapes = Json::array();
  for (const ViewShape& s : view.shapes) {
    Json shape = {{"semi_axes", {rounded(s.semi_axes.x()), rounded(s.semi_axes.y()), rounded(s.semi_axes.z())}},
                  {"exponents", {s.exponents.x(), s.exponents.y()}}};
    if (s.polytope) shape["polytope"] = *s.polytope;
    shapes.push_back(std::move(shape));
  }
  Json frames = Json::array();
  for (const ViewFrame& frame : view.frames) {
    frames.push_back({{"time", rounded(frame.time)},
                      {"positions", packed(frame.positions)},
                      {"orientations", packed(frame.orientations)}});
  }
  return {{"box", view.box},
          {"number", view.number},
          {"shown", view.shape_of.size()},
          {"shapes", std::move(shapes)},
          {"polytopes", polytopes_json(view)},
          {"shape_of", packed(view.shape_of)},
          {"species_of", packed(view.species_of)},
          {"frames", std::move(frames)},
          {"note", view.note}};
}

/// Returns whether a value is one of the orientation, which spheres do not have.
bool is_of_orientation(const std::string& key) {
  const Observable* known = find_observable(key);
  return known != nullptr && known->of_orientation;
}

Json headlines_json(const std::vector<Headline>& headlines, Detail detail) {
  Json list = Json::array();
  for (const Headline& h : headlines) {
    if (detail == Detail::slim) {
      list.push_back({{"key", h.key}, {"value", number_json(h.value)}});
      continue;
    }
    list.push_back({{"key", h.key},
                    {"symbol", h.symbol},
                    {"name", h.name},
                    {"unit", h.unit},
                    {"meaning", h.meaning},
                    {"of_orientation", is_of_orientation(h.key)},
                    {"value", number_json(h.value)},
                    {"error", number_json(h.error)},
                    {"missing", h.missing}});
  }
  return list;
}

/// Returns the part of a summary that the page shows; all of it, or what it draws.
Json summary_json(const nlohmann::json& summary, Detail detail) {
  if (detail == Detail::full || !summary.is_object()) return summary;
  Json some = Json::object();
  for (const char* key :
       {"version", "seed", "fit_windows", "wave_numbers", "van_hove_lags", "counters", "performance", "audit"}) {
    if (summary.contains(key)) some[key] = summary[key];
  }
  return some;
}

/// Returns the config without lines that are comments.
std::string config_text(const std::string& config, Detail detail) {
  if (detail == Detail::full) return config;
  std::string text;
  for (std::size_t begin = 0; begin < config.size();) {
    const std::size_t end = std::min(config.find('\n', begin), config.size() - 1) + 1;
    const std::string line = config.substr(begin, end - begin);
    if (!line.starts_with('#')) text += line;
    begin = end;
  }
  return text;
}

Json run_json(const RunReport& run, Detail detail) {
  Json remarks = Json::array();
  for (const Remark& r : run.remarks) {
    remarks.push_back({{"kind", to_string(r.kind)}, {"label", r.label}, {"text", r.text}});
  }
  Json species = Json::array();
  for (const SpeciesReport& s : run.species) {
    species.push_back(
        {{"title", s.title}, {"oriented", s.oriented}, {"headlines", headlines_json(s.headlines, detail)}});
  }
  Json curves = Json::object();
  for (const Curves& c : run.curves) curves[c.name] = curves_json(c, detail);
  return {{"name", run.name},
          {"path", run.path.string()},
          {"title", run.title},
          {"remarks", std::move(remarks)},
          {"headlines", headlines_json(run.headlines, detail)},
          {"species", std::move(species)},
          {"oriented", run.oriented},
          {"rotational_freedoms", run.rotational_freedoms},
          {"number", run.config.number},
          {"summary", summary_json(run.summary, detail)},
          {"config", config_text(run.config_text, detail)},
          {"log", detail == Detail::full ? run.log : std::string()},
          {"curves", std::move(curves)},
          {"view", run.view ? view_json(*run.view) : Json(nullptr)}};
}

Json line_json(const CurvePlot& plot, const CurveLine& line) {
  const CurveFile* file = find_curves(plot.file);
  constexpr std::array kKinds = {"", "slope", "stretched", "mean"};
  Json json = {{"column", line.column}, {"label", line.label}};
  if (is_of_orientation(plot, line)) json["of_orientation"] = true;
  if (!line.about.empty()) json["about"] = line.about;
  if (!line.y_label.empty()) json["y_label"] = line.y_label;
  const auto is_split = [&](Split split) {
    const auto by = [&](const Column& c) { return c.name == line.column && c.split == split; };
    return file != nullptr && std::any_of(file->columns.begin(), file->columns.end(), by);
  };
  if (is_split(Split::wave_numbers) || is_split(Split::collective)) json["wave_numbers"] = true;
  if (is_split(Split::lags)) json["lags"] = true;
  if (line.fit.kind == Fit::Kind::none) return json;
  json["fit"] = {{"kind", kKinds[static_cast<std::size_t>(line.fit.kind)]},
                 {"keys", line.fit.keys},
                 {"window", line.fit.window},
                 {"factor", line.fit.factor},
                 {"label", line.fit.label},
                 {"about", line.fit.about}};
  return json;
}

/// Lists the plots that the front end draws.
Json plots_json(const Report& report) {
  Json list = Json::array();
  for (const CurvePlot& plot : plots()) {
    if (!is_shown(plot, report)) continue;
    Json lines = Json::array();
    for (const CurveLine& line : plot.lines) lines.push_back(line_json(plot, line));
    list.push_back({{"id", plot.id},
                    {"title", plot.title},
                    {"about", plot.about},
                    {"file", plot.file},
                    {"x", {{"label", plot.x_label}, {"log", plot.log_x}}},
                    {"y", {{"label", plot.y_label}, {"log", plot.log_y}}},
                    {"normalised", plot.normalised},
                    {"lines", std::move(lines)}});
  }
  return list;
}

/// Returns JSON for <script>, which may contain neither "</script" nor "<!--": in JSON every < is within a string.
/// Bytes of a path or a log that are not UTF-8 are replaced, not refused.
std::string script_text(const Json& json) {
  constexpr Escape kEscapes[] = {{'<', "\\u003c"}};
  return escaped(json.dump(-1, ' ', false, Json::error_handler_t::replace), kEscapes);
}

/// Returns a field of the table: a number if it is one.
Json field_json(const std::string& field) {
  if (field.empty()) return nullptr;
  const std::optional<double> value = finite_number(field);
  return value ? Json(*value) : Json(field);
}

/// Returns value, error, the reason for which there is none, and the values that it is the mean of.
Json measured_json(const Measured& m) {
  return {number_json(m.value), number_json(m.error), m.missing, m.replicas};
}

Json point_json(const SweepPointReport& point, bool embedded) {
  Json keys = Json::array();
  for (const std::string& key : point.keys) keys.push_back(field_json(key));
  Json values = Json::array();
  for (const Measured& m : point.values) values.push_back(measured_json(m));
  return {{"keys", std::move(keys)},
          {"values", std::move(values)},
          {"status", point.status},
          {"message", point.message},
          {"equilibrated", point.equilibrated},
          {"directory", point.directory},
          {"embedded", embedded},
          {"oriented", !point.run || point.run->oriented},
          {"group", point.group}};
}

Json sweep_json(const SweepReport& sweep, const std::vector<bool>& embedded) {
  Json points = Json::array();
  Json names = Json::array();
  for (const std::string& key : sweep.keys) names.push_back({{"label", key_label(key)}, {"symbol", key_symbol(key)}});
  for (std::size_t k = 0; k < sweep.points.size(); ++k) points.push_back(point_json(sweep.points[k], embedded[k]));
  Json groups = Json::array();
  for (const std::vector<Measured>& group : sweep.groups) {
    Json values = Json::array();
    for (const Measured& m : group) values.push_back(measured_json(m));
    groups.push_back(std::move(values));
  }
  return {{"name", sweep.name},
          {"path", sweep.path.string()},
          {"keys", sweep.keys},
          {"key_names", std::move(names)},
          {"observables", headlines_json(sweep.observables, Detail::full)},
          {"points", std::move(points)},
          {"groups", std::move(groups)}};
}

}  // namespace

bool is_shown(const CurvePlot& plot, const Report& report) {
  const auto has_file = [&](const RunReport& run) { return run.find(plot.file) != nullptr; };
  if (!plot.optional || std::any_of(report.runs.begin(), report.runs.end(), has_file)) return true;
  return report.sweep && std::any_of(report.sweep->points.begin(), report.sweep->points.end(),
                                     [&](const SweepPointReport& point) { return point.run && has_file(*point.run); });
}

std::string report_data(const Report& report) {
  std::string scripts;
  Json data = {{"program", version()},
               {"title", report.title},
               {"plots", plots_json(report)},
               {"card", keys_by(&Places::card)},
               {"opened", keys_by(&Places::opened)}};
  if (report.sweep) {
    std::vector<bool> embedded;
    for (const SweepPointReport& point : report.sweep->points) {
      const bool shown = point.run && scripts.size() < kMostOfPoints;
      embedded.push_back(shown);
      if (!shown) continue;
      scripts += fmt::format("<script type=\"application/json\" id=\"point-{}\">{}</script>\n", embedded.size() - 1,
                             script_text(run_json(*point.run, Detail::slim)));
    }
    data["sweep"] = sweep_json(*report.sweep, embedded);
  } else {
    Json runs = Json::array();
    for (const RunReport& run : report.runs) runs.push_back(run_json(run, Detail::full));
    data["runs"] = std::move(runs);
  }
  return "<script type=\"application/json\" id=\"data\">" + script_text(data) + "</script>\n" + scripts;
}

}  // namespace hardbody
