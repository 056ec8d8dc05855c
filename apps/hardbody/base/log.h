#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace hardbody {

/// A run's log.txt: what happened when. Each line is on the disk before the run goes on.
class Log {
 public:
  enum class Begin { afresh, at_the_end };  ///< of what the file holds

  /// Throws std::runtime_error.
  Log(const std::filesystem::path& path, Begin begin);

  /// A line that cannot be written is lost; the run is worth more.
  void line(std::string_view text);

  /// Since the construction.
  double seconds() const;

 private:
  std::ofstream file_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace hardbody
