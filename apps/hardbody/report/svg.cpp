#include "report/svg.h"

#include "report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace hardbody {
namespace {

constexpr double kPlotWidth = 560;
constexpr double kPlotHeight = 340;
constexpr double kPlotLeft = 66;
constexpr double kPlotRight = 14;
constexpr double kPlotTop = 14;
constexpr double kPlotBottom = 48;
constexpr std::size_t kPlotColours = 8;  ///< classes c0 to c7 of the style

/// Axis: maps data to the page.
class PlotAxis {
 public:
  PlotAxis(bool logarithmic, double page_from, double page_to)
      : logarithmic_(logarithmic), page_from_(page_from), page_to_(page_to) {}

  bool takes(double x) const { return std::isfinite(x) && (!logarithmic_ || x > 0); }
  void include(double x) {
    if (!takes(x)) return;
    low_ = std::min(low_, scale(x));
    high_ = std::max(high_, scale(x));
  }
  bool is_logarithmic() const { return logarithmic_; }
  bool empty() const { return low_ > high_; }

  /// Extends the range around the data, so that a constant is a line in the middle.
  void widen() {
    const double least = logarithmic_ ? 0.1 : 1e-6 * std::max(1.0, std::abs(low_));
    const double margin = std::max(0.04 * (high_ - low_), least);
    low_ -= margin;
    high_ += margin;
  }

  double place(double x) const { return page_from_ + (scale(x) - low_) / (high_ - low_) * (page_to_ - page_from_); }

  /// Returns the values to be marked: decades, or round numbers.
  std::vector<double> ticks() const {
    std::vector<double> list;
    const double step = logarithmic_ ? std::max(1.0, std::ceil((high_ - low_) / 6)) : round_step();
    for (double k = std::ceil(low_ / step); k * step <= high_; ++k) {
      list.push_back(logarithmic_ ? std::pow(10, k * step) : k * step);
    }
    return list;
  }

 private:
  double scale(double x) const { return logarithmic_ ? std::log10(x) : x; }

  double round_step() const {
    const double raw = (high_ - low_) / 6;
    const double decade = std::pow(10, std::floor(std::log10(raw)));
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor * decade >= raw) return factor * decade;
    }
    return 10 * decade;
  }

  bool logarithmic_;
  double page_from_;
  double page_to_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

std::string tick_text(double x) {
  return std::abs(x) < 1e-12 ? "0" : fmt::format("{:.4g}", x);
}

std::string grid(const PlotAxis& x, const PlotAxis& y) {
  std::string svg;
  for (const double value : x.ticks()) {
    const double place = x.place(value);
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{0:.1f} {1}V{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" class=\"mid\">{4}</text>", place,
        kPlotTop, kPlotHeight - kPlotBottom, kPlotHeight - kPlotBottom + 17, tick_text(value));
  }
  for (const double value : y.ticks()) {
    const double place = y.place(value);
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{1} {0:.1f}H{2}\"/><text x=\"{3}\" y=\"{4:.1f}\" class=\"end\">{5}</text>", place,
        kPlotLeft, kPlotWidth - kPlotRight, kPlotLeft - 7, place + 4, tick_text(value));
  }
  return svg;
}

/// Largest part of a value by which a logarithmic axis is extended downwards for an error bar; longer bars end there.
constexpr double kDeepestBar = 0.9;

/// Returns the ends of the error bar of a point: low, high; nullopt if it has none.
std::optional<std::pair<double, double>> bar_of(const PlotSeries& series, std::size_t k, const PlotAxis& y) {
  if (k >= series.error.size() || !(series.error[k] > 0)) return std::nullopt;
  const double value = series.y[k];
  const double low = value - series.error[k];
  return std::pair(y.is_logarithmic() ? std::max(low, (1 - kDeepestBar) * value) : low, value + series.error[k]);
}

/// Returns the values that point k is the mean of and that have a place on the axis.
std::vector<double> spread_of(const PlotSeries& series, std::size_t k, const PlotAxis& y) {
  std::vector<double> values = k < series.spread.size() ? series.spread[k] : std::vector<double>();
  std::erase_if(values, [&](double value) { return !y.takes(value); });
  return values.size() > 1 ? values : std::vector<double>();
}

/// Returns a line through the points, interrupted where one is missing, and the points with their error bars.
std::string drawn(const PlotSeries& series, std::size_t index, const PlotAxis& x, const PlotAxis& y) {
  std::string line;
  std::string points;
  std::string bars;
  std::string spread;  // dots: lines of no length with round ends
  bool on = false;
  for (std::size_t k = 0; k < series.x.size() && k < series.y.size(); ++k) {
    if (!x.takes(series.x[k]) || !y.takes(series.y[k])) {
      on = false;
      continue;
    }
    const double px = x.place(series.x[k]);
    const double py = y.place(series.y[k]);
    line += fmt::format("{}{:.1f} {:.1f}", on ? "L" : "M", px, py);
    if (const auto bar = bar_of(series, k, y)) {
      bars += fmt::format("M{:.1f} {:.1f}V{:.1f}", px, y.place(bar->first), y.place(bar->second));
    }
    for (const double value : spread_of(series, k, y)) {
      spread += fmt::format("M{:.1f} {:.1f}h0", px, y.place(value));
    }
    const bool open = k < series.open.size() && series.open[k];
    points += fmt::format("<circle{} cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>", open ? " class=\"open\"" : "", px, py,
                          open ? 3.2 : 1.8);
    on = true;
  }
  if (!bars.empty()) bars = fmt::format("<path class=\"bars\" d=\"{}\"/>", bars);
  if (!spread.empty()) spread = fmt::format("<path class=\"spread\" d=\"{}\"/>", spread);
  return fmt::format("<g class=\"series c{}\">{}<path d=\"{}\"/>{}{}</g>", index % kPlotColours, spread, line, bars,
                     points);
}

std::string legend(const Plot& plot) {
  if (plot.series.size() < 2) return "";
  std::string html = "<p class=\"legend\">";
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    html += fmt::format("<span class=\"key c{}\">{}</span> ", k % kPlotColours, html_text(plot.series[k].name));
  }
  return html + "</p>";
}

}  // namespace

std::string svg_plot(const Plot& plot) {
  PlotAxis x(plot.log_x, kPlotLeft, kPlotWidth - kPlotRight);
  PlotAxis y(plot.log_y, kPlotHeight - kPlotBottom, kPlotTop);
  for (const PlotSeries& s : plot.series) {
    for (std::size_t k = 0; k < s.x.size() && k < s.y.size(); ++k) {
      if (!x.takes(s.x[k]) || !y.takes(s.y[k])) continue;
      x.include(s.x[k]);
      y.include(s.y[k]);
      for (const double value : spread_of(s, k, y)) y.include(value);
      const auto bar = bar_of(s, k, y);
      if (!bar) continue;
      y.include(bar->first);
      y.include(bar->second);
    }
  }
  if (x.empty() || y.empty()) return "";
  x.widen();
  y.widen();
  std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", kPlotWidth, kPlotHeight,
                                html_text(plot.title));
  svg += grid(x, y);
  svg += fmt::format("<text x=\"{}\" y=\"{}\" class=\"mid\">{}</text>", (kPlotLeft + kPlotWidth - kPlotRight) / 2,
                     kPlotHeight - 8, html_text(plot.x_label));
  svg += fmt::format("<text transform=\"translate(14 {}) rotate(-90)\" class=\"mid\">{}</text>",
                     (kPlotTop + kPlotHeight - kPlotBottom) / 2, html_text(plot.y_label));
  for (std::size_t k = 0; k < plot.series.size(); ++k) svg += drawn(plot.series[k], k, x, y);
  return svg + "</svg>" + legend(plot);
}

}  // namespace hardbody
