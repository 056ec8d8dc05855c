#pragma once

#include <string_view>

namespace hardbody {

/// The front end as it was built in; the script is empty where there was no npm to bundle it.
std::string_view report_script();
std::string_view report_style();         ///< of the script
std::string_view report_static_style();  ///< of a page without script, and the script's too

}  // namespace hardbody
