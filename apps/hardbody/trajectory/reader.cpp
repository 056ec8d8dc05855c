#include "trajectory/reader.h"

#include "base/errors.h"
#include "io/stored_bytes.h"
#include "trajectory/gsd/frames.h"
#include "trajectory/lammps/dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace hardbody {
namespace {

using namespace std::string_view_literals;

constexpr std::uint64_t kLongestBeginning = 4096;
constexpr std::string_view kGsdBeginning = "\xDF\x65\xDF\x65"sv;

/// Format that is recognised by some of its first bytes.
struct Format {
  std::size_t place;
  std::string_view bytes;
  const char* name;
  const char* advice;
};

constexpr const char* kOurOwn = "runs write one with trajectory = [\"gsd\"] or [\"lammps\"] under [output]";

constexpr std::array kFormats = {
    Format{0, "\x1F\x8B"sv, "is compressed by gzip", "gunzip unpacks it"},
    Format{0, "\x28\xB5\x2F\xFD"sv, "is compressed by zstd", "unzstd unpacks it"},
    Format{0,
           "\xFD"
           "7zXZ"sv,
           "is compressed by xz", "unxz unpacks it"},
    Format{0, "BZh"sv, "is compressed by bzip2", "bunzip2 unpacks it"},
    Format{0, "PK\x03\x04"sv, "is a zip archive", "unzip unpacks it"},
    Format{8, "DUMPATOM"sv, "is a binary LAMMPS dump", "LAMMPS's binary2txt converts it"},
    Format{8, "DUMPCUSTOM"sv, "is a binary LAMMPS dump", "LAMMPS's binary2txt converts it"},
    Format{0, "<?xml"sv, "is an XML file, as VTK files are", kOurOwn},
    Format{0, "<VTKFile"sv, "is a VTK file", kOurOwn},
    Format{0, "# vtk "sv, "is a legacy VTK file", kOurOwn},
    Format{0, "CRYST1"sv, "is a PDB file", "OVITO can export one"},
    Format{0, "HEADER"sv, "is a PDB file", "OVITO can export one"},
    Format{0, "\x00\x00\x07\xCB"sv, "is an XTC file", "OVITO can export one"},
    Format{0, "\x00\x00\x07\xC9"sv, "is a TRR file", "OVITO can export one"},
    Format{0, "CDF"sv, "is a NetCDF file", "OVITO can export one"},
    Format{0, "\x89HDF"sv, "is an HDF5 file", "OVITO can export one"},
    Format{4, "CORD"sv, "is a DCD file", "OVITO can export one, with the topology beside it"},
};

std::string_view first_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
  return line;
}

/// Recognises text formats of other programs by their first lines; nullopt for others.
std::optional<Format> text_format(std::string_view text) {
  constexpr const char* kExport = "OVITO can export one";
  std::string_view rest = text;
  const std::string_view first = first_line(rest);
  const std::string_view second = first_line(rest);
  if (!first.empty() && first.find_first_not_of("0123456789") == std::string_view::npos) {
    const bool extended = second.find("Lattice=") != std::string_view::npos;
    return Format{0, "", extended ? "is an extended xyz file" : "is an xyz file", kExport};
  }
  const auto has = [&](std::string_view words) { return text.find(words) != std::string_view::npos; };
  if ((has(" xlo xhi") || has(" atom types")) && (has(" atoms\n") || has(" ellipsoids\n"))) {
    return Format{0, "", "is a LAMMPS data file", "LAMMPS's write_dump writes one after read_data"};
  }
  return std::nullopt;
}

std::optional<Format> other_format(std::string_view beginning) {
  for (const Format& format : kFormats) {
    if (beginning.size() >= format.place && beginning.substr(format.place).starts_with(format.bytes)) return format;
  }
  return text_format(beginning);
}

}  // namespace

std::optional<std::uint64_t> last_frame(const TrajectoryReader& reader) {
  std::uint64_t k = reader.frame_count();
  while (k > 0 && !reader.has_positions(k - 1)) --k;
  return k > 0 ? std::optional(k - 1) : std::nullopt;
}

std::unique_ptr<TrajectoryReader> open_frames(const std::filesystem::path& path) {
  std::unique_ptr<StoredBytes> bytes = open_stored_bytes(path);
  const std::string beginning = bytes->read(0, std::min(bytes->size(), kLongestBeginning));
  if (beginning.starts_with(kGsdBeginning)) return std::make_unique<GsdReader>(std::move(bytes), path.string());
  if (const std::optional<Format> other = other_format(beginning)) {
    throw InputError(fmt::format("{}: {}; accepted: a GSD file or a LAMMPS text dump ({})", path.string(), other->name,
                                 other->advice));
  }
  return std::make_unique<LammpsReader>(std::move(bytes), path.string());
}

}  // namespace hardbody
