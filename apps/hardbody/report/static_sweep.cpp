#include "base/find.h"
#include "base/number_text.h"
#include "plot/levels.h"
#include "registry/key_names.h"
#include "registry/observables.h"
#include "report/page.h"
#include "report/svg.h"
#include "run/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace hardbody {
namespace {

constexpr double kLogarithmic = 4;  ///< ratio of the extremes from which on an axis of positive numbers is logarithmic
constexpr std::size_t kLeastOfMap = 3;
constexpr const char* kSeed = "seed";

/// Returns the values of a swept key at the points; NaN if it is not a number.
std::vector<double> key_numbers(const SweepReport& sweep, std::size_t key) {
  std::vector<double> numbers;
  for (const SweepPointReport& point : sweep.points) {
    numbers.push_back(finite_number(point.keys[key]).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return numbers;
}

/// Swept key that is a number at all points and takes several values; the seed only where nothing else varies.
struct SweptAxis {
  std::string name;
  std::vector<double> x;  ///< value at each point
  bool log;
};

/// Returns whether two keys take their values together: no plane lies between them.
bool are_zipped(const SweptAxis& a, const SweptAxis& b) {
  std::map<double, double> partner;
  for (std::size_t p = 0; p < a.x.size(); ++p) {
    if (partner.try_emplace(a.x[p], b.x[p]).first->second != b.x[p]) return false;
  }
  return true;
}

std::vector<SweptAxis> axes_of(const SweepReport& sweep) {
  std::vector<SweptAxis> axes;
  for (std::size_t k = 0; k < sweep.keys.size(); ++k) {
    SweptAxis axis{sweep.keys[k], key_numbers(sweep, k), false};
    if (!std::all_of(axis.x.begin(), axis.x.end(), [](double x) { return std::isfinite(x); })) continue;
    const auto [low, high] = std::minmax_element(axis.x.begin(), axis.x.end());
    if (!(*low < *high)) continue;
    axis.log = *low > 0 && *high > kLogarithmic * *low;
    axes.push_back(std::move(axis));
  }
  if (axes.size() > 1) std::erase_if(axes, [](const SweptAxis& axis) { return axis.name == kSeed; });
  if (axes.size() == 2 && are_zipped(axes[0], axes[1])) axes.pop_back();
  return axes;
}

std::string label_of(const Headline& observable) {
  return observable.unit.empty() ? observable.symbol : fmt::format("{} [{}]", observable.symbol, observable.unit);
}

std::string figure(const char* classes, const std::string& title, const std::string& drawing) {
  return fmt::format("<figure class=\"{}\"><figcaption>{}</figcaption>{}</figure>\n", classes, html_text(title),
                     drawing);
}

std::string map_figure(const SweepReport& sweep, const std::vector<SweptAxis>& axes, std::size_t observable) {
  Map map;
  map.x_label = key_label(axes[0].name);
  map.y_label = key_label(axes[1].name);
  map.scales = {axes[0].log, axes[1].log};
  std::vector<Sample> samples;
  for (std::size_t p = 0; p < sweep.points.size(); ++p) {
    const double value = value_at(sweep.points[p], observable);
    if (!std::isfinite(value)) continue;
    samples.push_back({axes[0].x[p], axes[1].x[p], value});
    map.marks.push_back({axes[0].x[p], axes[1].x[p], sweep.points[p].equilibrated == "false"});
  }
  if (samples.size() < kLeastOfMap) return "";
  const Headline& name = sweep.observables[observable];
  map.levels = map_levels(samples, chosen_levels(samples), map.scales);
  map.legend = {label_of(name)};
  return figure("card map", label_of(name), map_svg(map));
}

std::string plot_figure(const SweepReport& sweep, const SweptAxis& axis, std::size_t observable) {
  std::map<double, std::vector<const SweepPointReport*>> points;  // of seeds, say
  for (std::size_t p = 0; p < sweep.points.size(); ++p) {
    if (std::isfinite(value_at(sweep.points[p], observable))) points[axis.x[p]].push_back(&sweep.points[p]);
  }
  const Headline& name = sweep.observables[observable];
  PlotSeries series{name.symbol, {}, {}};
  for (const auto& [x, same] : points) {
    const Measured mean = pooled_over(same, observable);
    series.x.push_back(x);
    series.y.push_back(mean.value);
    series.error.push_back(mean.error);
    series.open.push_back(
        std::any_of(same.begin(), same.end(), [](const auto* p) { return p->equilibrated == "false"; }));
    series.spread.push_back(mean.replicas);
  }
  const std::string label = label_of(name);
  const bool open = std::find(series.open.begin(), series.open.end(), true) != series.open.end();
  const std::string svg = svg_plot({label, key_label(axis.name), label, axis.log, false, {series}});
  const std::string title = open ? label + "; open: not shown to be equilibrated" : label;
  return svg.empty() ? "" : figure("card", title, svg);
}

/// Returns how many points have a value of an observable.
auto number_known(const SweepReport& sweep, std::size_t observable) {
  return std::count_if(sweep.points.begin(), sweep.points.end(),
                       [&](const SweepPointReport& point) { return std::isfinite(value_at(point, observable)); });
}

/// Returns the observables that are drawn: those with most values first, in the registry's order of maps among equals.
std::vector<std::size_t> drawn_observables(const SweepReport& sweep) {
  std::vector<std::size_t> drawn;
  for (const std::string& wanted : keys_by(&Places::map)) {
    const Headline* found = find_by(sweep.observables, &Headline::key, wanted);
    if (found != nullptr) drawn.push_back(static_cast<std::size_t>(found - sweep.observables.data()));
  }
  std::stable_sort(drawn.begin(), drawn.end(),
                   [&](std::size_t a, std::size_t b) { return number_known(sweep, a) > number_known(sweep, b); });
  return drawn;
}

std::string figures(const SweepReport& sweep) {
  const std::vector<SweptAxis> axes = axes_of(sweep);
  std::string html;
  for (const std::size_t observable : drawn_observables(sweep)) {
    if (axes.size() == 2) html += map_figure(sweep, axes, observable);
    if (axes.size() == 1) html += plot_figure(sweep, axes[0], observable);
  }
  return html.empty() ? html : "<section aria-label=\"Plots\" class=\"plots\">\n" + html + "</section>\n";
}

/// Returns a table with one row for each point.
std::string sweep_table(const SweepReport& sweep) {
  std::string html = "<table class=\"card\"><thead><tr>";
  for (const std::string& key : sweep.keys) html += fmt::format("<th scope=\"col\">{}</th>", html_text(key_label(key)));
  for (const Headline& o : sweep.observables) {
    html += fmt::format("<th scope=\"col\">{}</th>", html_text(label_of(o)));
  }
  html += "<th scope=\"col\">status</th></tr></thead><tbody>\n";
  for (const SweepPointReport& point : sweep.points) {
    html += "<tr>";
    for (const std::string& key : point.keys) html += fmt::format("<th scope=\"row\">{}</th>", html_text(key));
    for (const Measured& m : point.values) {
      const std::string why = m.missing.empty() ? "" : fmt::format(" title=\"{}\"", html_text(m.missing));
      html += fmt::format("<td{}>{}</td>", why, html_text(format_estimate({m.value, m.error})));
    }
    html += fmt::format("<td>{} {}</td></tr>\n", html_text(point.status), html_text(point.message));
  }
  return html + "</tbody></table>\n";
}

}  // namespace

std::string static_sweep(const SweepReport& sweep) {
  return figures(sweep) + sweep_table(sweep);
}

}  // namespace hardbody
