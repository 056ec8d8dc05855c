#pragma once

#include "report/run.h"
#include "report/sweep.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// What a page is made of.
struct Report {
  std::string title;
  std::vector<RunReport> runs;       ///< one, or several side by side
  std::optional<SweepReport> sweep;  ///< instead of runs
};

/// The page: one HTML file that opens without a network. With the front end that was built in it is interactive;
/// without one its plots are drawn here.
std::string report_page(const Report& report);

/// How every report begins.
inline constexpr std::string_view kReportBeginning =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta http-equiv=\"Content-Security-Policy\"";

/// Text in HTML, also within quotes.
std::string html_text(std::string_view text);

/// Plots and tables that need no script.
std::string static_body(const Report& report);

/// What of it is of a sweep: maps over two swept numbers, or plots against one, and the table of all points.
std::string static_sweep(const SweepReport& sweep);

/// The data that the front end draws, as <script> elements of JSON; those of a sweep's points are read one by one.
std::string report_data(const Report& report);

}  // namespace hardbody
