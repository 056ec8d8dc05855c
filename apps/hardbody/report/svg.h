#pragma once

#include <string>
#include <vector>

namespace hardbody {

struct PlotSeries {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> error{};                ///< standard errors; empty: none are drawn
  std::vector<bool> open{};                   ///< points that are drawn open; empty: none
  std::vector<std::vector<double>> spread{};  ///< values that each y is the mean of; empty: none are drawn
};

/// Plot of a static report. Points that are not finite, or not positive on a logarithmic axis, are left out.
struct Plot {
  std::string title;
  std::string x_label;
  std::string y_label;
  bool log_x = false;
  bool log_y = false;
  std::vector<PlotSeries> series;
};

/// Returns the plot as inline SVG, with classes for its colours; empty if there is no point to draw.
std::string svg_plot(const Plot& plot);

}  // namespace hardbody
