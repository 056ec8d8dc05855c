#include "base/find.h"
#include "base/version.h"
#include "registry/curves.h"
#include "report/page.h"
#include "report/svg.h"

#include <fmt/format.h>

#include <algorithm>

namespace hardbody {
namespace {

/// Columns of a plot that a run has: of one run all of all bodies, of several runs the first one.
std::vector<std::string> columns_of(const CurvePlot& wanted, const Curves& curves, bool all, bool oriented) {
  std::vector<std::string> columns;
  const auto add = [&](const std::string& name) {
    if (curves.find(name) != nullptr && (all || columns.empty())) columns.push_back(name);
  };
  for (const CurveLine& line : wanted.lines) {
    if (!oriented && is_of_orientation(wanted, line)) continue;
    add(line.column);
    for (std::size_t k = 1; k <= ed::kMostWaveNumbers; ++k) add(fmt::format("{}_q{}", line.column, k));
    // Every second lag of the van Hove function, from the longest on.
    std::size_t lags = 0;
    while (curves.find(fmt::format("{}_t{}", line.column, lags + 1)) != nullptr) ++lags;
    for (std::size_t k = lags; k > 0; k = k > 2 ? k - 2 : 0) add(fmt::format("{}_t{}", line.column, k));
  }
  return columns;
}

/// Returns "q l = 7.05" for F_self at a wave number of the run; else the column's name.
std::string series_label(const RunReport& run, const CurvePlot& plot, const std::string& column) {
  const nlohmann::json& numbers = member(run.summary, "wave_numbers");
  for (std::size_t k = 0; numbers.is_array() && k < numbers.size(); ++k) {
    if (!numbers[k].is_number() || column != fmt::format("{}_q{}", plot.lines[0].column, k + 1)) continue;
    return fmt::format("q l = {:.3g}", numbers[k].get<double>());
  }
  const nlohmann::json& lags = member(run.summary, "van_hove_lags");
  for (std::size_t k = 0; lags.is_array() && k < lags.size(); ++k) {
    if (!lags[k].is_number() || column != fmt::format("{}_t{}", plot.lines[0].column, k + 1)) continue;
    return fmt::format("t = {:.3g}", lags[k].get<double>());
  }
  return column;
}

std::string label_of(const Curves& curves, const std::string& column) {
  for (const std::string& name : curves.columns) {
    if (Curves::bare_name(name) == column) return name;
  }
  return column;
}

Plot plot_of(const CurvePlot& wanted, const CurveFile& file, const std::vector<RunReport>& runs) {
  Plot plot;
  plot.title = wanted.title;
  plot.log_x = wanted.log_x;
  plot.log_y = wanted.log_y;
  const std::string x = required_columns(file)[0];
  for (const RunReport& run : runs) {
    const Curves* curves = run.find(wanted.file);
    if (curves == nullptr) continue;
    const std::vector<double>* abscissa = curves->find(x);
    const std::vector<std::string> columns = columns_of(wanted, *curves, runs.size() == 1, run.oriented);
    if (abscissa == nullptr || columns.empty()) continue;
    plot.x_label = label_of(*curves, x);
    plot.y_label = label_of(*curves, columns[0]);
    for (const std::string& column : columns) {
      const std::vector<double>* error = curves->find(column + "_error");
      plot.series.push_back({runs.size() == 1 ? series_label(run, wanted, column) : run.name, *abscissa,
                             *curves->find(column), error == nullptr ? std::vector<double>() : *error});
    }
  }
  return plot;
}

std::string plots_section(const Report& report) {
  const std::vector<RunReport>& runs = report.runs;
  std::string html = "<section aria-label=\"Plots\" class=\"plots\">\n";
  const bool any_oriented = std::any_of(runs.begin(), runs.end(), [](const RunReport& run) { return run.oriented; });
  for (const CurvePlot& wanted : plots()) {
    const CurveFile* file = find_curves(wanted.file);
    if (file == nullptr || !is_shown(wanted, report) || (is_of_orientation(wanted) && !any_oriented)) continue;
    const std::string svg = svg_plot(plot_of(wanted, *file, runs));
    html +=
        fmt::format("<figure class=\"card\"><figcaption>{}</figcaption>{}</figure>\n", html_text(wanted.title),
                    svg.empty() ? "<p class=\"none\">no values: nothing, or too little, has been measured</p>" : svg);
  }
  return html + "</section>\n";
}

std::string remarks(const RunReport& run) {
  std::string html = "<ul class=\"remarks\">";
  for (const Remark& r : run.remarks) {
    html += fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", to_string(r.kind), html_text(r.label), html_text(r.text));
  }
  return html + "</ul>\n";
}

std::string cell(const Headline& headline) {
  return html_text(headline_text(headline));
}

/// Returns a table with one row a quantity, one column a run.
std::string headline_table(const std::vector<RunReport>& runs) {
  std::string html = "<table class=\"card\"><thead><tr><th scope=\"col\">quantity</th>";
  for (const RunReport& run : runs) html += fmt::format("<th scope=\"col\">{}</th>", html_text(run.name));
  html += "<th scope=\"col\">unit</th><th scope=\"col\">definition</th></tr></thead><tbody>\n";
  for (const Headline& row : runs[0].headlines) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>", html_text(row.name));
    for (const RunReport& run : runs) {
      const Headline* own = find_by(run.headlines, &Headline::key, row.key);
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
  html += headline_table(report.runs) + plots_section(report);
  for (const RunReport& run : report.runs) {
    html += fmt::format("<h2>{}</h2>\n", html_text(run.title)) + details(run);
  }
  return html + kWhy;
}

}  // namespace hardbody
