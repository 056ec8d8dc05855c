#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// The lines of a file or of standard input, one at a time, as soon as they are there. Of a line that is too long no
/// more is kept than the limit.
class LineReader {
 public:
  /// `path`: "-" is standard input. Throws InputError if it cannot be opened.
  LineReader(const std::string& path, std::size_t longest);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// Goes to the next line, waiting for it; false at the end. Throws InputError if reading fails.
  bool next();

  /// Without its line break; empty if it is too long. Valid until next().
  std::string_view line() const { return line_; }
  bool too_long() const { return too_long_; }
  long number() const { return number_; }  ///< from 1

  /// Nobody can be waiting for an answer before writing the next line.
  bool is_regular_file() const { return is_regular_file_; }

 private:
  bool fill();
  void append(std::string_view piece);

  std::string name_;
  std::size_t longest_;
  int descriptor_;
  bool is_regular_file_ = false;
  std::vector<char> buffer_;
  std::string_view unread_;  ///< of buffer_
  std::string line_;
  bool too_long_ = false;
  long number_ = 0;
};

}  // namespace hardbody
