#include "report/page.h"

#include "base/escape.h"
#include "report/assets.h"

#include <fmt/format.h>

namespace hardbody {
namespace {

/// Policy that nothing may be fetched: a report can never tell anybody that it is being read.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; "
    "form-action 'none'";

std::string head(const Report& report, std::string_view style) {
  return fmt::format(
      "{} content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{} - hardbody</title>\n"
      "<link rel=\"icon\" href=\"data:,\">\n<style>\n{}\n{}</style>\n</head>\n",
      kReportBeginning, kPolicy, html_text(report.title), report_static_style(), style);
}

}  // namespace

std::string html_text(std::string_view text) {
  constexpr Escape kEscapes[] = {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  return escaped(text, kEscapes);
}

std::string report_page(const Report& report) {
  const std::string_view script = report_script();
  if (script.empty()) {
    return head(report, "") + "<body>\n" + static_body(report) + "</body>\n</html>\n";
  }
  std::string page = head(report, report_style());
  page +=
      "<body>\n<div id=\"report\"><noscript><p class=\"notice\">This report draws itself with JavaScript, which is "
      "switched off; the numbers are in summary.json.</p></noscript></div>\n";
  page += report_data(report) + "<script>\n";
  page += script;
  return page + "</script>\n</body>\n</html>\n";
}

}  // namespace hardbody
