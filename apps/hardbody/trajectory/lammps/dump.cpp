#include "trajectory/lammps/dump.h"

#include "base/errors.h"
#include "base/number_text.h"
#include "base/shapes.h"
#include "io/text_file.h"
#include "trajectory/lammps/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// Returns "shapex shapey shapez Phi Theta" of each type; diameters of 0, as of points, for shapes that these columns
/// do not tell.
std::vector<std::string> shape_columns(const Frame& frame) {
  std::vector<std::string> columns;
  for (const FrameType& type : frame.types) {
    const ShapeNumbers numbers = type.shape ? numbers_of(*type.shape) : ShapeNumbers();
    const bool told = type.shape && (has_semi_axes(numbers.kind) || numbers.kind == ShapeKind::sphere);
    const Vector3d a = told ? numbers.lengths : Vector3d::Zero();
    const Eigen::Vector2d& e = numbers.exponents;
    columns.push_back(fmt::format("{} {} {} {} {}", 2 * a.x(), 2 * a.y(), 2 * a.z(), e.y(), e.x()));
  }
  return columns;
}

std::string frame_text(const Frame& frame) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS pp pp pp\n", frame.step,
                 frame.bodies.size());
  for (int k = 0; k < 3; ++k) fmt::format_to(out, "{} {}\n", -frame.box[k] / 2, frame.box[k] / 2);
  fmt::format_to(out,
                 "ITEM: ATOMS id type x y z quatw quati quatj quatk shapex shapey shapez SuperquadricRoundness.Phi "
                 "SuperquadricRoundness.Theta ix iy iz\n");
  const std::vector<std::string> shapes = shape_columns(frame);
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const FrameBody& body = frame.bodies[i];
    const Eigen::Vector4d q = quaternion_of(body.rotation);
    const Vector3d image = (body.unwrapped - body.position).cwiseQuotient(frame.box).array().round();
    fmt::format_to(out, "{} {} {} {} {} {} {} {} {} {} {:.0f} {:.0f} {:.0f}\n", i + 1, body.group + 1,
                   body.position.x(), body.position.y(), body.position.z(), q[0], q[1], q[2], q[3], shapes[body.type],
                   image.x() + 0.0, image.y() + 0.0, image.z() + 0.0);
  }
  return fmt::to_string(text);
}

}  // namespace

void LammpsWriter::open(FileMark mark) {
  mark_ = mark;
  if (mark.frames > 0) write_at(path_, mark.bytes, "");
}

void LammpsWriter::append(const Frame& frame) {
  const std::string text = frame_text(frame);
  write_at(path_, mark_.bytes, text, Flush::later);
  mark_.bytes += text.size();
  ++mark_.frames;
}

// ---- Reading

namespace {

constexpr std::string_view kBegin = "ITEM: TIMESTEP";

InputError foreign(const std::string& name) {
  return InputError(fmt::format("{}: is neither a GSD file nor a LAMMPS text dump; accepted: one of these", name));
}

/// Returns whether a text begins like a dump.
bool begins_dump(std::string_view text) {
  return text.starts_with(kBegin) || text.starts_with(kTimeItem) || text.starts_with(kUnitsItem);
}

/// Returns the begin of the line before the one at `at` > 0.
std::size_t line_before(std::string_view text, std::size_t at) {
  const std::size_t end = at < 2 ? std::string_view::npos : text.rfind('\n', at - 2);
  return end == std::string_view::npos ? 0 : end + 1;
}

/// Returns the begin of the frame whose time step is at `at`: items before it have one line and one value each.
std::size_t begin_of(std::string_view text, std::size_t at) {
  while (at > 0) {
    const std::size_t item = line_before(text, line_before(text, at));
    if (!text.substr(item).starts_with(kTimeItem) && !text.substr(item).starts_with(kUnitsItem)) break;
    if (text.substr(item).starts_with(kBegin)) break;
    at = item;
  }
  return at;
}

/// Calls f with the text of [begin, end) in pieces. Each begins where the previous one ended, and is extended by `more`
/// bytes if there are any.
template <class F>
void in_pieces(const StoredBytes& bytes, std::uint64_t begin, std::uint64_t end, std::uint64_t more, F&& f) {
  constexpr std::uint64_t kReadSize = std::uint64_t{1} << 20;
  for (std::uint64_t at = begin; at < end; at += kReadSize) {
    const std::uint64_t size = std::min(kReadSize, end - at);
    f(at, size, bytes.read(at, std::min(size + more, bytes.size() - at)));
  }
}

/// Maximum length of the text that may precede a frame's time step.
constexpr std::uint64_t kLongestPrelude = 1024;

}  // namespace

LammpsReader::LammpsReader(std::unique_ptr<StoredBytes> bytes, std::string name)
    : bytes_(std::move(bytes)), name_(std::move(name)), frames_(find_frames()) {
  // Only the last frame can have been cut off.
  cut_off_ = !is_whole(frames_.back());
  if (cut_off_) frames_.pop_back();
}

std::vector<LammpsReader::Place> LammpsReader::find_frames() const {
  const std::uint64_t size = bytes_->size();
  if (!begins_dump(bytes_->read(0, std::min<std::uint64_t>(size, kBegin.size())))) throw foreign(name_);
  std::vector<std::uint64_t> steps;
  char before = '\n';  // the byte before a piece
  in_pieces(*bytes_, 0, size, kBegin.size() - 1, [&](std::uint64_t at, std::uint64_t length, std::string_view text) {
    const std::size_t zero = text.find('\0');
    if (zero != std::string_view::npos) {
      throw InputError(fmt::format("{}: byte {} is 0; accepted: a complete LAMMPS text dump", name_,
                                   at + static_cast<std::uint64_t>(zero)));
    }
    for (std::size_t k = text.find(kBegin); k < length; k = text.find(kBegin, k + 1)) {
      if ((k == 0 ? before : text[k - 1]) == '\n') steps.push_back(at + k);
    }
    before = text[length - 1];
  });
  std::vector<Place> frames;
  for (const std::uint64_t step : steps) {
    const std::uint64_t from = step - std::min(step, kLongestPrelude);
    const std::string text = bytes_->read(from, std::min(size, step + kBegin.size()) - from);
    const std::uint64_t begin = from + begin_of(text, static_cast<std::size_t>(step - from));
    if (!frames.empty()) frames.back().end = begin;
    frames.push_back({begin, size});
  }
  if (frames.empty() || frames[0].begin != 0) throw foreign(name_);
  return frames;
}

/// Returns whether a frame has a line for each of its bodies.
bool LammpsReader::is_whole(Place frame) const {
  constexpr std::uint64_t kLongestHead = 4096;
  const std::string head = bytes_->read(frame.begin, std::min(frame.end - frame.begin, kLongestHead));
  DumpLines lines(head);
  std::optional<std::string_view> line = lines.next();
  while (line && !line->starts_with("ITEM: NUMBER OF ATOMS")) line = lines.next();
  line = lines.next();
  const std::optional<double> count = line ? finite_number(*line) : std::nullopt;
  if (!count) return false;
  double ends = 0;
  in_pieces(*bytes_, frame.begin + head.size() - lines.rest().size(), frame.end, 0,
            [&](std::uint64_t /*at*/, std::uint64_t /*length*/, std::string_view text) {
              ends += static_cast<double>(std::count(text.begin(), text.end(), '\n'));
            });
  return ends >= *count + 5;
}

Frame LammpsReader::read(std::uint64_t k) const {
  const Place place = frames_.at(k);
  const std::string text = bytes_->read(place.begin, place.end - place.begin);
  return read_dump_frame(text, name_, k);
}

}  // namespace hardbody
