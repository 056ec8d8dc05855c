#pragma once

#include "registry/curves.h"
#include "report/run.h"
#include "report/sweep.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Content of a page.
struct Report {
  std::string title;
  std::vector<RunReport> runs;       ///< one run, or several side by side
  std::optional<SweepReport> sweep;  ///< sweep, in place of runs
};

/// Returns the page: one HTML file that opens without a network. It is interactive if the front end was built in;
/// otherwise its plots are drawn here.
std::string report_page(const Report& report);

/// Beginning of every report.
inline constexpr std::string_view kReportBeginning =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\"";

/// Returns whether a plot belongs into a report: an optional one only if some run has its file.
bool is_shown(const CurvePlot& plot, const Report& report);

/// Escapes text for HTML, also within quotes.
std::string html_text(std::string_view text);

/// Returns plots and tables that need no script.
std::string static_body(const Report& report);

/// Returns the part of that for a sweep: maps over two swept numbers, or plots against one, and the table of all
/// points.
std::string static_sweep(const SweepReport& sweep);

/// Returns the data that the front end draws, as <script> elements of JSON; those of a sweep's points are read one by
/// one.
std::string report_data(const Report& report);

}  // namespace hardbody
