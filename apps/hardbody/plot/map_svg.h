#pragma once

#include "plot/contours.h"

#include <string>
#include <vector>

namespace hardbody {

/// Axes that are logarithmic.
struct MapScales {
  bool log_x = false;
  bool log_y = false;
};

/// Lines of one level of one observable.
struct MapLevel {
  std::string value;   ///< name of the observable
  std::size_t of = 0;  ///< index of the observable, which determines its colour
  double level = 0;
  std::vector<ContourLine> lines;
};

/// Measured state point; an open mark says that it was not shown to be equilibrated.
struct MapMark {
  double x;
  double y;
  bool open;
};

/// Content of a drawing.
struct Map {
  std::string x_label;
  std::string y_label;
  MapScales scales;
  std::vector<MapMark> marks;
  std::vector<MapLevel> levels;
  std::vector<std::string> legend;  ///< names of the observables; what follows an underscore is an index
};

/// Returns the drawing as SVG. Coordinates of lines and marks are those of the data, also with logarithmic axes.
std::string map_svg(const Map& map);

}  // namespace hardbody
