#pragma once

#include <string_view>

namespace hardbody {

/// Returns the front end that was built in; empty if there was no npm to bundle it.
std::string_view report_script();
std::string_view report_style();         ///< style of the page with script
std::string_view report_static_style();  ///< style of the page without script, also used with it

}  // namespace hardbody
