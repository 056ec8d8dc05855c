#pragma once

#include "plot/contours.h"

#include <string>
#include <vector>

namespace hardbody {

/// Which axes are logarithmic.
struct MapScales {
  bool log_x = false;
  bool log_y = false;
};

/// The lines of one level of one observable.
struct MapLevel {
  std::string value;   ///< name of the observable
  std::size_t of = 0;  ///< number of the observable: its colour
  double level = 0;
  std::vector<ContourLine> lines;
};

/// A measured state point; open ones are less to be trusted.
struct MapMark {
  double x;
  double y;
  bool open;
};

/// All that is drawn.
struct Map {
  std::string x_name;
  std::string y_name;
  MapScales scales;
  std::vector<MapMark> marks;
  std::vector<MapLevel> levels;
};

/// A drawing of it. Coordinates of lines and marks are those of the data, also with logarithmic axes.
std::string map_svg(const Map& map);

}  // namespace hardbody
