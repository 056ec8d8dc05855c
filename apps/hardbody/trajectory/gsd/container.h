#pragma once

/// The container of GSD files (glotzerlab's General Simulation Data, layout 1 and 2): named arrays, frame by frame.
/// Nothing of what they mean; that is gsd_frames.h.
///
/// A file is a header of 256 bytes, an index of 32 bytes an array, a list of names, and the arrays themselves, in any
/// order but the header first; little-endian.

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

/// What the numbers of an array are.
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

/// Bytes of one number; 0 for what is no type.
std::size_t size_of(GsdType type);

/// Where an array of a frame stands in the file.
struct GsdChunk {
  std::uint64_t frame = 0;
  std::uint64_t rows = 0;
  std::uint64_t location = 0;
  std::uint32_t columns = 0;
  std::uint16_t name = 0;  ///< its number in the list of names
  GsdType type = GsdType::uint8;

  std::uint64_t bytes() const { return rows * columns * size_of(type); }
};

/// A GSD file that is read. Whatever the bytes are, no more memory is taken than a small multiple of what they are, and
/// what is wrong with them is thrown as InputError, `name: what; accepted: ..`.
class GsdFile {
 public:
  /// `name`: what messages call the file. Reads header, names and index. A file that ends before the arrays that its
  /// index lists is one that was cut off: its last frames are left out, from the first one that is not whole on.
  GsdFile(std::unique_ptr<StoredBytes> bytes, std::string name);

  const std::string& name() const { return name_; }
  const std::string& application() const { return application_; }
  const std::string& schema() const { return schema_; }
  std::uint32_t schema_version() const { return schema_version_; }  ///< 0x00010004: 1.4

  std::uint64_t frame_count() const { return frame_count_; }
  /// Leaves out the frames from `count` on, which are not whole.
  void keep_frames(std::uint64_t count);
  /// Whether frames were left out.
  bool cut_off() const { return cut_off_; }

  /// Whether there can be an array of that name.
  bool has_name(std::string_view name) const { return number_of(name).has_value(); }
  /// Whether a frame behind the first one has an array of that name.
  bool stored_later(std::string_view name) const;
  /// The array of a frame; null if it has none of that name.
  const GsdChunk* find(std::uint64_t frame, std::string_view name) const;
  /// Its bytes.
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
  std::vector<GsdChunk> chunks_;           ///< sorted by frame, then name
  std::vector<std::uint64_t> last_frame_;  ///< by name: the last frame that has such an array; 0: none, or the first
};

/// An array to be written.
struct GsdArray {
  std::uint16_t name;
  GsdType type;
  std::uint64_t rows;
  std::uint32_t columns;
  std::string bytes;
};

/// The start of a file that will hold `entries` arrays at most of these names: header, an empty index, the names.
struct GsdHead {
  std::string application;
  std::string schema;
  std::uint32_t schema_version;
  std::vector<std::string> names;
  std::uint64_t entries;

  std::string bytes() const;
  /// Length of that.
  std::uint64_t size() const;
  /// Where entry k of the index stands.
  static std::uint64_t entry_location(std::uint64_t k);
};

/// The arrays of one frame, sorted by name: their bytes one after the other, to stand at `location`, and their entries
/// in the index.
struct GsdFrameBytes {
  std::string data;
  std::string index;
};
GsdFrameBytes gsd_frame_bytes(std::uint64_t frame, const std::vector<GsdArray>& arrays, std::uint64_t location);

}  // namespace hardbody
