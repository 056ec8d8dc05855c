#include "report/page.h"
#include "report/svg.h"
#include "run/table.h"

#include "base/version.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

namespace hardbody {
namespace {

/// Content of a plot: columns of a file of observables/.
struct PlotChoice {
  const char* file;
  const char* title;
  bool log_x;
  bool log_y;
  std::vector<const char*> columns;  ///< columns for one run; for several runs the first one is used
};

const std::vector<PlotChoice>& choices() {
  static const std::vector<PlotChoice> list = {
      {"msd", "Mean square displacement", true, true, {"msd"}},
      {"rotational_msd", "Rotational mean square displacement", true, true, {"rot_msd", "rot_msd_body"}},
      {"c1", "C1, first-order orientational correlation", true, false, {"c1"}},
      {"c2", "C2, second-order orientational correlation", true, false, {"c2"}},
      {"f_self", "F_self", true, false, {"f_self_q1", "f_self_q2", "f_self_q3", "f_self_q4"}},
      {"velocity", "Velocity correlations", true, false, {"vacf", "wacf"}},
      {"alpha2", "Non-Gaussian parameter", true, false, {"alpha2"}},
      {"g_r", "Pair correlations", false, false, {"g", "g2"}},
      {"s_q", "Structure factor", false, false, {"S"}},
      {"blocks", "Nematic order", false, false, {"S"}},
      {"blocks", "Compressibility factor", false, false, {"Z"}},
  };
  return list;
}

/// Returns the column of the abscissa; for blocks.csv the ends of the blocks.
std::string x_column(const Curves& curves) {
  return curves.name == "blocks" ? "end" : Curves::bare_name(curves.columns[0]);
}

std::string label_of(const Curves& curves, const std::string& column) {
  for (const std::string& name : curves.columns) {
    if (Curves::bare_name(name) == column) return name;
  }
  return column;
}

Plot plot_of(const PlotChoice& choice, const std::vector<RunReport>& runs) {
  Plot plot;
  plot.title = choice.title;
  plot.log_x = choice.log_x;
  plot.log_y = choice.log_y;
  for (const RunReport& run : runs) {
    const Curves* curves = run.find(choice.file);
    if (curves == nullptr || curves->columns.empty()) continue;
    const std::string x = x_column(*curves);
    for (std::size_t k = 0; k < (runs.size() == 1 ? choice.columns.size() : 1); ++k) {
      const std::vector<double>* abscissa = curves->find(x);
      const std::vector<double>* ordinate = curves->find(choice.columns[k]);
      if (abscissa == nullptr || ordinate == nullptr) continue;
      plot.x_label = label_of(*curves, x);
      plot.y_label = k == 0 ? label_of(*curves, choice.columns[0]) : plot.y_label;
      plot.series.push_back({runs.size() == 1 ? choice.columns[k] : run.name, *abscissa, *ordinate});
    }
  }
  return plot;
}

std::string plots(const std::vector<RunReport>& runs) {
  std::string html = "<section aria-label=\"Plots\" class=\"plots\">\n";
  for (const PlotChoice& choice : choices()) {
    const std::string svg = svg_plot(plot_of(choice, runs));
    html +=
        fmt::format("<figure class=\"card\"><figcaption>{}</figcaption>{}</figure>\n", html_text(choice.title),
                    svg.empty() ? "<p class=\"none\">no values: nothing, or too little, has been measured</p>" : svg);
  }
  return html + "</section>\n";
}

std::string remarks(const RunReport& run) {
  constexpr std::array kClasses = {"good", "warning", "bad"};
  std::string html = "<ul class=\"remarks\">";
  for (const Remark& r : run.remarks) {
    html += fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", kClasses[static_cast<std::size_t>(r.kind)],
                        html_text(r.label), html_text(r.text));
  }
  return html + "</ul>\n";
}

std::string cell(const Headline& headline) {
  return html_text(headline_text(headline));
}

const Headline* find(const std::vector<Headline>& list, const std::string& key) {
  for (const Headline& h : list) {
    if (h.key == key) return &h;
  }
  return nullptr;
}

/// Returns a table with one row a quantity, one column a run.
std::string headline_table(const std::vector<RunReport>& runs) {
  std::string html = "<table class=\"card\"><thead><tr><th scope=\"col\">quantity</th>";
  for (const RunReport& run : runs) html += fmt::format("<th scope=\"col\">{}</th>", html_text(run.name));
  html += "<th scope=\"col\">unit</th><th scope=\"col\">definition</th></tr></thead><tbody>\n";
  for (const Headline& row : runs[0].headlines) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>", html_text(row.name));
    for (const RunReport& run : runs) {
      const Headline* own = find(run.headlines, row.key);
      html += fmt::format("<td>{}</td>", own == nullptr ? "" : cell(*own));
    }
    html += fmt::format("<td>{}</td><td>{}</td></tr>\n", html_text(row.unit), html_text(row.meaning));
  }
  return html + "</tbody></table>\n<p>Errors are standard errors over blocks of the run.</p>\n";
}

std::string details(const RunReport& run) {
  std::string html;
  for (const SpeciesReport& species : run.species) {
    html += fmt::format("<h3>{}</h3><table class=\"card\"><tbody>", html_text(species.title));
    for (const Headline& h : species.headlines) {
      html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td></tr>\n", html_text(h.name), cell(h),
                          html_text(h.unit));
    }
    html += "</tbody></table>\n";
  }
  const auto block = [&](const char* name, const std::string& text) {
    if (text.empty()) return;
    html +=
        fmt::format("<details><summary>{}</summary><pre class=\"card\">{}</pre></details>\n", name, html_text(text));
  };
  block("config.toml", run.config_text);
  if (!run.summary.is_null()) {
    block("counters", run.summary.value("counters", nlohmann::json()).dump(2));
    block("performance", run.summary.value("performance", nlohmann::json()).dump(2));
  }
  block("log.txt", run.log);
  return html;
}

}  // namespace

std::string static_body(const Report& report) {
  std::string html = fmt::format("<main class=\"static\">\n<p class=\"over\">hardbody {}</p>\n<h1>{}</h1>\n", version(),
                                 html_text(report.title));
  constexpr const char* kWhy =
      "<p class=\"notice\">This report is static: the program was built without the interactive front end, for which "
      "it needs npm.</p>\n</main>\n";
  if (report.sweep) return html + static_sweep(*report.sweep) + kWhy;
  for (const RunReport& run : report.runs) {
    html += fmt::format("<p class=\"path\">{}</p>\n", html_text(run.path.string())) + remarks(run);
  }
  html += headline_table(report.runs) + plots(report.runs);
  for (const RunReport& run : report.runs) {
    html += fmt::format("<h2>{}</h2>\n", html_text(run.title)) + details(run);
  }
  return html + kWhy;
}

}  // namespace hardbody
