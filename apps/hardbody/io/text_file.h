#pragma once

#include <ed/archive.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hardbody {

/// A file that could not be written: the disk's or the system's doing, which the user can mend.
class WriteError : public std::runtime_error {
 public:
  WriteError(const std::filesystem::path& path, int error);

  /// Whether room was lacking: on the disk, of a quota, or below the limit of a file's size.
  bool no_room() const { return no_room_; }

 private:
  bool no_room_;
};

/// Absolute name of the same file, without "." and "..". As to the system, ".." behind a symbolic link to a directory
/// is the parent of that directory; other links stay in the name.
std::filesystem::path absolute_path(const std::filesystem::path& path);

/// The whole file, which must be a regular one: of a pipe nobody knows how long it makes one wait. Throws InputError if
/// it cannot be read or is longer than `limit` bytes.
std::string read_file(const std::filesystem::path& path, std::size_t limit);

/// Throws InputError unless there is nothing at `path`, or a file that begins with `beginning`: one of the same kind,
/// which may be replaced. A link counts as what it points to.
void check_replaceable(const std::filesystem::path& path, std::string_view beginning);

/// Writes under a temporary name, flushes to the disk and renames, so that a reader (or a crash) never sees
/// half a file. A link stays one; what is neither a file nor a link to one is left alone. Throws WriteError.
void write_file(const std::filesystem::path& path, std::string_view content);

/// Takes a file's bytes piece by piece.
using Sink = ed::archive::Sink;

/// The same of a content that `make` hands over in pieces. What that throws is passed on; no file is left then.
void write_file(const std::filesystem::path& path, const std::function<void(const Sink&)>& make);

/// Whether bytes are on the disk when they are written, or with the system, which outlives the process only.
enum class Flush { now, later };

/// Makes the file end with `content` after its first `position` bytes (at most its length); a new file is begun at
/// position 0. Throws WriteError; the first `position` bytes are then as they were, and the last.
void write_at(const std::filesystem::path& path, std::uint64_t position, std::string_view content,
              Flush flush = Flush::now);

/// Makes the file end after its first `position` bytes, as far as that can be done: shorter needs no room.
void cut_off(const std::filesystem::path& path, std::uint64_t position);

/// Replaces bytes within a file; what is beyond its end makes it longer. Throws WriteError.
void overwrite_at(const std::filesystem::path& path, std::uint64_t position, std::string_view content,
                  Flush flush = Flush::now);

/// Brings to the disk what was written for later. Throws WriteError.
void flush_file(const std::filesystem::path& path);

/// One value of many in a message is cut after so many bytes.
inline constexpr std::size_t kShownLength = 60;

/// Text for a one-line message: line breaks and control characters become blanks, long text is cut.
std::string one_line(std::string_view text, std::size_t longest = 400);

}  // namespace hardbody
