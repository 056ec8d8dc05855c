#include "runs/bind.h"

#include <registry/curves.h>

#include <nanobind/nanobind.h>

namespace hardbody::python {
namespace {

namespace nb = nanobind;

nb::object unicode(const std::string& utf8) {
  return nb::str(utf8.c_str(), utf8.size());
}

/// Returns the plots of reports that are drawn from files.
nb::list curve_plots() {
  nb::list list;
  for (const CurvePlot& plot : plots()) {
    if (plot.file.empty()) continue;
    nb::dict one;
    one["id"] = unicode(plot.id);
    one["title"] = unicode(plot.title);
    one["file"] = unicode(plot.file);
    one["x_label"] = unicode(plot.x_label);
    one["y_label"] = unicode(plot.y_label);
    one["log_x"] = plot.log_x;
    one["log_y"] = plot.log_y;
    one["normalised"] = plot.normalised;
    nb::list lines;
    for (const CurveLine& line : plot.lines) lines.append(nb::make_tuple(unicode(line.column), unicode(line.label)));
    one["lines"] = lines;
    list.append(one);
  }
  return list;
}

}  // namespace

void bind_plots(nb::module_& module) {
  module.def("curve_plots", &curve_plots, nb::sig("def curve_plots() -> list[dict[str, typing.Any]]"),
             "Plots of reports that are drawn from files in observables/, as the program's registry has them.");
}

}  // namespace hardbody::python
