#pragma once

#include <ed/sink.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hardbody {

/// Error when a file cannot be written, caused by the disk or the system, which the user can resolve.
class WriteError : public std::runtime_error {
 public:
  /// Message: "<path>: cannot be written: <why>", by default the system's words for the error.
  WriteError(const std::filesystem::path& path, int error, const std::string& why = "");

  /// Returns the file's name.
  const std::string& path() const { return path_; }
  /// Returns the error's number, of errno.
  int number() const { return number_; }
  /// Returns the message without the file's name.
  const std::string& reason() const { return reason_; }
  /// Returns whether there was no room: on the disk, of a quota, or below the limit of a file's size.
  bool no_room() const { return no_room_; }

 private:
  std::string path_;
  int number_;
  std::string reason_;
  bool no_room_;
};

/// Returns the absolute name of a file, without "." and "..". As for the system, ".." after a symbolic link to a
/// directory is the parent of that directory; other links stay in the name.
std::filesystem::path absolute_path(const std::filesystem::path& path);

/// Returns the content of a regular file (of a pipe it is not known how long reading takes). Throws InputError if it
/// cannot be read or is longer than `limit` bytes.
std::string read_file(const std::filesystem::path& path, std::size_t limit);

/// Throws InputError unless there is nothing at `path`, or a file that begins with `beginning`: one of the same kind,
/// which may be replaced. Links are followed.
void check_replaceable(const std::filesystem::path& path, std::string_view beginning);

/// Writes under a temporary name, flushes to the disk and renames, so that a reader (or a crash) never sees half a
/// file. A link remains a link; anything that is neither a file nor a link to one is left unchanged. Throws WriteError.
void write_file(const std::filesystem::path& path, std::string_view content);

using ed::archive::Sink;

/// Writes a file whose content `make` produces in pieces. Exceptions of `make` are passed on; no file is left then.
void write_file(const std::filesystem::path& path, const std::function<void(const Sink&)>& make);

/// Whether written bytes are on the disk at once, or with the system, which survives only the process.
enum class Flush { now, later };

/// Makes the file end with `content` after its first `position` bytes (at most its length); a new file is begun at
/// position 0. Throws WriteError; the file then consists of its first `position` bytes, unchanged.
void write_at(const std::filesystem::path& path, std::uint64_t position, std::string_view content,
              Flush flush = Flush::now);

/// Truncates the file to its first `position` bytes, as far as possible: truncation needs no room.
void cut_off(const std::filesystem::path& path, std::uint64_t position);

/// Replaces bytes within a file; content beyond its end extends it. Throws WriteError.
void overwrite_at(const std::filesystem::path& path, std::uint64_t position, std::string_view content,
                  Flush flush = Flush::now);

/// Flushes to the disk what was written with Flush::later. Throws WriteError.
void flush_file(const std::filesystem::path& path);

/// Maximum number of bytes shown of a single value in a message.
inline constexpr std::size_t kShownLength = 60;

/// Converts text for a one-line message: line breaks and control characters become blanks, long text is cut.
std::string one_line(std::string_view text, std::size_t longest = 400);

}  // namespace hardbody
