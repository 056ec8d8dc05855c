#include "trajectory/gsd/container.h"

#include "base/errors.h"

#include <ed/archive.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <tuple>
#include <utility>

namespace hardbody {

using ed::archive::Reader;
using ed::archive::Writer;

namespace {

constexpr std::uint64_t kGsdMagic = 0x65DF65DF65DF65DF;
constexpr std::uint32_t kVersion2 = 0x00020000;
constexpr std::uint32_t kVersion1 = 0x00010000;
constexpr std::uint32_t kVersion03 = 0x00000003;  ///< a draft that its own library still reads
constexpr std::uint32_t kVersion3 = 0x00030000;
constexpr std::size_t kHeader = 256;
constexpr std::size_t kEntry = 32;
constexpr std::size_t kName = 64;  ///< bytes of a name of version 1, and unit of the names' block
constexpr std::size_t kTextInHeader = 64;
constexpr std::uint64_t kMostNames = std::uint64_t{1} << 24;  ///< bytes of all names
/// Number of entries of the index that are read at once: a file may have holes in the place of the index.
constexpr std::uint64_t kEntriesAtOnce = 65536;
constexpr std::size_t kReserved = 80;

/// Returns the error "is cut off ..", for a file that is shorter than its header says.
InputError ends_early(const std::string& name, std::uint64_t size, const char* before) {
  return InputError(
      fmt::format("{}: is cut off after {} bytes, before {}; accepted: a complete GSD file", name, size, before));
}

InputError damaged(const std::string& name, const std::string& what) {
  return InputError(fmt::format("{}: is damaged: {}; accepted: an undamaged GSD file", name, what));
}

/// Returns the text up to the first 0.
std::string text_of(std::string_view bytes) {
  return std::string(bytes.substr(0, std::min(bytes.find('\0'), bytes.size())));
}

/// Returns whether `count` things of `size` bytes from `location` on are within a file; no product overflows.
bool fits(std::uint64_t location, std::uint64_t count, std::uint64_t size, std::uint64_t file) {
  return location <= file && (count == 0 || size == 0 || count <= (file - location) / size);
}

struct Header {
  std::uint64_t magic;
  std::uint64_t index_location;
  std::uint64_t index_entries;
  std::uint64_t names_location;
  std::uint64_t names_blocks;
  std::uint32_t schema_version;
  std::uint32_t version;
};

Header take_header(Reader& reader) {
  Header header{};
  reader(header.magic, header.index_location, header.index_entries, header.names_location, header.names_blocks,
         header.schema_version, header.version);
  return header;
}

GsdChunk take_entry(Reader& reader, std::uint8_t& flags) {
  GsdChunk chunk;
  reader(chunk.frame, chunk.rows, chunk.location, chunk.columns, chunk.name, chunk.type, flags);
  return chunk;
}

void put_entry(Writer& writer, const GsdChunk& chunk) {
  writer(chunk.frame, chunk.rows, chunk.location, chunk.columns, chunk.name, chunk.type, std::uint8_t{0});
}

/// Returns the fault of an entry of the index; nullptr: it may be read, if the file is long enough.
const char* fault(const GsdChunk& chunk, std::uint8_t flags, std::size_t names, std::uint64_t entries) {
  if (size_of(chunk.type) == 0) return "an array of unknown type";
  if (flags != 0) return "an array with unknown flags";
  if (chunk.name >= names) return "an array whose name is not in the list";
  if (chunk.columns == 0) return "an array without columns";
  if (chunk.frame >= entries) return "a frame beyond the end of the index";
  return nullptr;
}

bool before(const GsdChunk& a, const GsdChunk& b) {
  return std::tie(a.frame, a.name) < std::tie(b.frame, b.name);
}

}  // namespace

std::size_t size_of(GsdType type) {
  constexpr std::array<std::size_t, 12> kSizes = {0, 1, 2, 4, 8, 1, 2, 4, 8, 4, 8, 1};
  const auto k = static_cast<std::size_t>(type);
  return k < kSizes.size() ? kSizes[k] : 0;
}

// ---- Reading

GsdFile::GsdFile(std::unique_ptr<StoredBytes> bytes, std::string name)
    : bytes_(std::move(bytes)), name_(std::move(name)) {
  const std::uint64_t size = bytes_->size();
  const std::string start = bytes_->read(0, std::min<std::uint64_t>(size, kHeader));
  if (start.size() < sizeof kGsdMagic || std::memcmp(start.data(), &kGsdMagic, sizeof kGsdMagic) != 0) {
    throw InputError(fmt::format("{}: is not a GSD file; accepted: a GSD file", name_));
  }
  if (start.size() < kHeader) throw ends_early(name_, size, "the end of its header");
  Reader reader(start);
  const Header header = take_header(reader);
  if (header.version != kVersion03 && (header.version < kVersion1 || header.version >= kVersion3)) {
    throw InputError(fmt::format("{}: has version {}.{} of the GSD layout; accepted: 1.0 to 2.x", name_,
                                 header.version >> 16, header.version & 0xFFFF));
  }
  application_ = text_of(reader.raw(kTextInHeader));
  schema_ = text_of(reader.raw(kTextInHeader));
  schema_version_ = header.schema_version;
  if (!fits(header.names_location, header.names_blocks, kName, size))
    throw ends_early(name_, size, "the end of its names");
  if (!fits(header.index_location, header.index_entries, kEntry, size)) {
    throw ends_early(name_, size, "the end of its index");
  }
  read_names(header.names_location, header.names_blocks, header.version < kVersion2);
  read_index(header.index_location, header.index_entries);
}

void GsdFile::read_names(std::uint64_t location, std::uint64_t blocks, bool fixed_length) {
  if (blocks > kMostNames / kName) throw damaged(name_, "more than 16 MiB of names");
  const std::string bytes = bytes_->read(location, blocks * kName);
  for (std::size_t at = 0; at < bytes.size() && bytes[at] != '\0';) {
    if (names_.size() > std::numeric_limits<std::uint16_t>::max()) throw damaged(name_, "more than 65536 names");
    const std::size_t limit = fixed_length ? kName : bytes.size() - at;
    names_.push_back(text_of(std::string_view(bytes).substr(at, limit)));
    if (names_.back().size() == limit) throw damaged(name_, "a name without an end");
    at += fixed_length ? kName : names_.back().size() + 1;
  }
}

void GsdFile::read_index(std::uint64_t location, std::uint64_t entries) {
  bool more = true;
  for (std::uint64_t first = 0; more && first < entries; first += kEntriesAtOnce) {
    const std::uint64_t number = std::min(kEntriesAtOnce, entries - first);
    const std::string bytes = bytes_->read(location + first * kEntry, number * kEntry);
    Reader reader(bytes);
    for (std::uint64_t k = 0; more && k < number; ++k) more = take_chunk(reader, entries);
  }
  if (!std::is_sorted(chunks_.begin(), chunks_.end(), before)) {
    std::stable_sort(chunks_.begin(), chunks_.end(), before);
  }
  note_last_frames();
}

void GsdFile::note_last_frames() {
  last_frame_.assign(names_.size(), 0);
  for (const GsdChunk& chunk : chunks_) last_frame_[chunk.name] = std::max(last_frame_[chunk.name], chunk.frame);
}

/// Adds an entry of the index; returns false if there are no more of complete frames.
bool GsdFile::take_chunk(Reader& reader, std::uint64_t entries) {
  std::uint8_t flags = 0;
  const GsdChunk chunk = take_entry(reader, flags);
  if (chunk.location == 0) return false;
  if (const char* why = fault(chunk, flags, names_.size(), entries)) throw damaged(name_, why);
  if (!chunks_.empty() && chunk.frame < chunks_.back().frame) throw damaged(name_, "frames in descending order");
  frame_count_ = chunk.frame + 1;
  if (!fits(chunk.location, chunk.rows, std::uint64_t{chunk.columns} * size_of(chunk.type), bytes_->size())) {
    keep_frames(chunk.frame);  // entries are written in this order, so that no complete frame can follow
    return false;
  }
  chunks_.push_back(chunk);
  return true;
}

void GsdFile::keep_frames(std::uint64_t count) {
  if (count >= frame_count_) return;
  frame_count_ = count;
  cut_off_ = true;
  std::erase_if(chunks_, [count](const GsdChunk& chunk) { return chunk.frame >= count; });
  note_last_frames();
}

std::optional<std::uint16_t> GsdFile::number_of(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::uint16_t>(found - names_.begin());
}

bool GsdFile::stored_later(std::string_view name) const {
  const std::optional<std::uint16_t> number = number_of(name);
  return number && last_frame_[*number] > 0;
}

const GsdChunk* GsdFile::find(std::uint64_t frame, std::string_view name) const {
  const std::optional<std::uint16_t> number = number_of(name);
  if (!number) return nullptr;
  GsdChunk wanted;
  wanted.frame = frame;
  wanted.name = *number;
  const auto found = std::lower_bound(chunks_.begin(), chunks_.end(), wanted, before);
  return found != chunks_.end() && !before(wanted, *found) ? &*found : nullptr;
}

std::string GsdFile::read(const GsdChunk& chunk) const {
  return bytes_->read(chunk.location, chunk.bytes());
}

// ---- Writing

namespace {

std::string names_block(const std::vector<std::string>& names) {
  std::string block;
  for (const std::string& name : names) block += name + '\0';
  block += '\0';
  block.resize((block.size() + kName - 1) / kName * kName);
  return block;
}

std::string text_in_header(const std::string& text) {
  std::string bytes = text.substr(0, kTextInHeader - 1);
  bytes.resize(kTextInHeader);
  return bytes;
}

}  // namespace

std::uint64_t GsdHead::entry_location(std::uint64_t k) {
  return kHeader + k * kEntry;
}

std::uint64_t GsdHead::size() const {
  return entry_location(entries) + names_block(names).size();
}

std::string GsdHead::bytes() const {
  const std::string block = names_block(names);
  Writer writer;
  writer(kGsdMagic, std::uint64_t{kHeader}, entries, entry_location(entries), std::uint64_t{block.size() / kName},
         schema_version, kVersion2);
  std::string bytes = writer.take() + text_in_header(application) + text_in_header(schema);
  bytes.resize(bytes.size() + kReserved + entries * kEntry);
  return bytes + block;
}

GsdFrameBytes gsd_frame_bytes(std::uint64_t frame, const std::vector<GsdArray>& arrays, std::uint64_t location) {
  GsdFrameBytes result;
  Writer index;
  for (const GsdArray& array : arrays) {
    put_entry(index, {frame, array.rows, location + result.data.size(), array.columns, array.name, array.type});
    result.data += array.bytes;
  }
  result.index = index.take();
  return result;
}

}  // namespace hardbody
