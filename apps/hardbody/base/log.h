#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace hardbody {

/// Log of a run in log.txt: events with their times. Each line is on the disk before the run continues.
class Log {
 public:
  enum class Begin { afresh, at_the_end };  ///< treatment of an existing file

  /// Opens the file. Throws std::runtime_error.
  Log(const std::filesystem::path& path, Begin begin);

  /// Writes a line. A line that cannot be written is lost, so that the run can continue.
  void line(std::string_view text);

  /// Returns the seconds since the construction.
  double seconds() const;

 private:
  std::ofstream file_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace hardbody
