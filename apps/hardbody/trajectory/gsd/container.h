#pragma once

/// Container of GSD files (glotzerlab's General Simulation Data, layout 1 and 2): named arrays, frame by frame. Their
/// meaning is in gsd/frames.h.
///
/// A file is a header of 256 bytes, an index of 32 bytes an array, a list of names, and the arrays themselves, in any
/// order except that the header is first; little-endian.

#include "io/stored_bytes.h"

#include <ed/archive.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Number type of an array.
enum class GsdType : std::uint8_t {
  uint8 = 1,
  uint16,
  uint32,
  uint64,
  int8,
  int16,
  int32,
  int64,
  float32,
  float64,
  character,
};

/// Returns the bytes of one number; 0 for an unknown type.
std::size_t size_of(GsdType type);

/// Location of an array of a frame in the file.
struct GsdChunk {
  std::uint64_t frame = 0;
  std::uint64_t rows = 0;
  std::uint64_t location = 0;
  std::uint32_t columns = 0;
  std::uint16_t name = 0;  ///< index of its name in the list of names
  GsdType type = GsdType::uint8;

  std::uint64_t bytes() const { return rows * columns * size_of(type); }
};

/// GSD file that is read. For any content, the memory used is limited to a small multiple of the file's size, and
/// faults are thrown as InputError, `name: what; accepted: ..`.
class GsdFile {
 public:
  /// Reads header, names and index. `name`: that of the file in messages. A file that ends before the arrays that its
  /// index lists was cut off: its last frames are left out, from the first incomplete one on.
  GsdFile(std::unique_ptr<StoredBytes> bytes, std::string name);

  const std::string& name() const { return name_; }
  const std::string& application() const { return application_; }
  const std::string& schema() const { return schema_; }
  std::uint32_t schema_version() const { return schema_version_; }  ///< 0x00010004: 1.4

  std::uint64_t frame_count() const { return frame_count_; }
  /// Leaves out the frames from `count` on, which are incomplete.
  void keep_frames(std::uint64_t count);
  /// Returns whether frames were left out.
  bool cut_off() const { return cut_off_; }

  /// Returns whether there can be an array of this name.
  bool has_name(std::string_view name) const { return number_of(name).has_value(); }
  /// Returns whether a frame after the first one has an array of this name.
  bool stored_later(std::string_view name) const;
  /// Returns the array of a frame; nullptr if it has none of this name.
  const GsdChunk* find(std::uint64_t frame, std::string_view name) const;
  /// Returns the bytes of an array.
  std::string read(const GsdChunk& chunk) const;

 private:
  std::optional<std::uint16_t> number_of(std::string_view name) const;
  void read_names(std::uint64_t location, std::uint64_t blocks, bool fixed_length);
  void read_index(std::uint64_t location, std::uint64_t entries);
  void note_last_frames();
  bool take_chunk(ed::archive::Reader& reader, std::uint64_t entries);

  std::unique_ptr<StoredBytes> bytes_;
  std::string name_;
  std::string application_;
  std::string schema_;
  std::uint32_t schema_version_ = 0;
  std::uint64_t frame_count_ = 0;
  bool cut_off_ = false;
  std::vector<std::string> names_;
  std::vector<GsdChunk> chunks_;  ///< sorted by frame, then name
  /// Last frame that has an array of each name; 0: none, or the first.
  std::vector<std::uint64_t> last_frame_;
};

/// Array to be written.
struct GsdArray {
  std::uint16_t name;
  GsdType type;
  std::uint64_t rows;
  std::uint32_t columns;
  std::string bytes;
};

/// Beginning of a file with up to `entries` arrays of these names: header, an empty index, the names.
struct GsdHead {
  std::string application;
  std::string schema;
  std::uint32_t schema_version;
  std::vector<std::string> names;
  std::uint64_t entries;

  std::string bytes() const;
  /// Returns its length.
  std::uint64_t size() const;
  /// Returns the position of entry k of the index.
  static std::uint64_t entry_location(std::uint64_t k);
};

/// Arrays of one frame, sorted by name: their bytes one after the other, to be written at `location`, and their entries
/// in the index.
struct GsdFrameBytes {
  std::string data;
  std::string index;
};
GsdFrameBytes gsd_frame_bytes(std::uint64_t frame, const std::vector<GsdArray>& arrays, std::uint64_t location);

}  // namespace hardbody
