#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Reader of a file or of standard input, line by line, as soon as a line is complete. Only the part of a line up to
/// the limit is stored.
class LineReader {
 public:
  /// Opens `path`; "-" is standard input. Throws InputError if it cannot be opened.
  LineReader(const std::string& path, std::size_t longest);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// Reads the next line, waiting for it; returns false at the end. Throws InputError if reading fails.
  bool next();

  /// Returns the line without its line break; empty if it is too long. Valid until next().
  std::string_view line() const { return line_; }
  bool too_long() const { return too_long_; }
  long number() const { return number_; }  ///< number of the line, from 1

  /// Returns whether the input is a regular file, so that no process waits for an answer before it writes the next
  /// line.
  bool is_regular_file() const { return is_regular_file_; }

 private:
  bool fill();
  void append(std::string_view piece);

  std::string name_;
  std::size_t longest_;
  int descriptor_;
  bool is_regular_file_ = false;
  std::vector<char> buffer_;
  std::string_view unread_;  ///< unread part of buffer_
  std::string line_;
  bool too_long_ = false;
  long number_ = 0;
};

}  // namespace hardbody
