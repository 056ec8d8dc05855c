#include "base/log.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <stdexcept>

namespace hardbody {

Log::Log(const std::filesystem::path& path, Begin begin)
    : file_(path, begin == Begin::afresh ? std::ios::trunc : std::ios::app), start_(std::chrono::steady_clock::now()) {
  if (!file_) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

void Log::line(std::string_view text) {
  const std::tm utc = fmt::gmtime(std::time(nullptr));
  file_.clear();  // after an earlier line that found the disk full
  file_ << fmt::format("{:%Y-%m-%d %H:%M:%S} UTC {:10.3f} s  {}\n", utc, seconds(), text) << std::flush;
}

double Log::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

}  // namespace hardbody
