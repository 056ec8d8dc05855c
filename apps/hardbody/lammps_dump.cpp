#include "lammps_dump.h"

#include "errors.h"
#include "number_text.h"
#include "text_file.h"

#include <Eigen/Geometry>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <variant>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// "shapex shapey shapez Phi Theta" of each type.
std::vector<std::string> shape_columns(const Frame& frame) {
  std::vector<std::string> columns;
  for (const FrameType& type : frame.types) {
    const Vector3d a = type.shape ? ed::half_extents(*type.shape) : Vector3d::Zero();
    const auto* barr = type.shape ? std::get_if<geom::Superellipsoid>(&*type.shape) : nullptr;
    columns.push_back(fmt::format("{} {} {} {} {}", 2 * a.x(), 2 * a.y(), 2 * a.z(), barr != nullptr ? barr->e2() : 1,
                                  barr != nullptr ? barr->e1() : 1));
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
                 "SuperquadricRoundness.Theta\n");
  const std::vector<std::string> shapes = shape_columns(frame);
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const FrameBody& body = frame.bodies[i];
    const Eigen::Quaterniond q = Eigen::Quaterniond(body.rotation).normalized();
    fmt::format_to(out, "{} {} {} {} {} {} {} {} {} {}\n", i + 1, body.group + 1, body.position.x(), body.position.y(),
                   body.position.z(), q.w(), q.x(), q.y(), q.z(), shapes[body.type]);
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

constexpr std::uint64_t kMostBodies = 100'000'000;
/// A stored quaternion's length may be off 1 by this: six digits.
constexpr double kDumpQuaternionTolerance = 1e-4;

/// The lines of a text, one after the other.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  /// Without its end; nothing after the last one that has an end.
  std::optional<std::string_view> next() {
    const std::size_t end = text_.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    std::string_view line = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  std::string_view rest() const { return text_; }

 private:
  std::string_view text_;
};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.empty()) return words;
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

/// One frame of a dump, read line by line.
class DumpFrame {
 public:
  DumpFrame(std::string_view text, const std::string& name, std::uint64_t k) : lines_(text), name_(name), k_(k) {}
  Frame read();

 private:
  InputError bad(const std::string& what, const std::string& accepted) const {
    return InputError(fmt::format("{}: frame {}: {}; accepted: {}", name_, k_, one_line(what, 120), accepted));
  }
  std::string_view line(const char* what) {
    const std::optional<std::string_view> found = lines_.next();
    if (!found) throw bad(fmt::format("ends before {}", what), "a whole LAMMPS text dump");
    return *found;
  }
  double number(std::string_view word, const char* what) const {
    const std::optional<double> value = finite_number(word);
    if (!value) throw bad(fmt::format("{} is \"{}\"", what, word), "a finite number");
    return *value;
  }

  void read_head(Frame& frame);
  void read_bounds(Frame& frame);
  void read_columns(std::string_view head);
  /// Columns of these names; nothing if one of them is missing.
  std::optional<std::vector<std::size_t>> columns(std::initializer_list<std::string_view> names) const;
  void read_body(const std::vector<std::string_view>& words, Frame& frame);
  void read_position(const std::vector<std::string_view>& words, const Frame& frame, FrameBody& body) const;
  void read_shape(const std::vector<std::string_view>& words, std::uint32_t type, Frame& frame, FrameBody& body);

  Lines lines_;
  const std::string& name_;
  std::uint64_t k_;
  Vector3d low_ = Vector3d::Zero();
  std::vector<std::string_view> names_;
  std::vector<std::pair<double, std::size_t>> order_;  ///< ids, and the bodies they are of
  std::map<std::uint32_t, std::uint32_t> groups_;      ///< by type
  std::map<std::string, std::uint32_t> types_;         ///< by type and shape, as text
};

/// What may stand before the time step: dump_modify has options for it.
constexpr std::string_view kTimeItem = "ITEM: TIME";
constexpr std::string_view kUnitsItem = "ITEM: UNITS";

void DumpFrame::read_head(Frame& frame) {
  std::string_view item = line("its time step");
  for (; item == kTimeItem || item == kUnitsItem; item = line("its time step")) {
    const std::string_view value = line("its time step");
    if (item == kTimeItem) frame.time = number(value, "the time");
  }
  const double step = number(line("its time step"), "the time step");
  frame.step = step >= 0 && step < 1e18 ? static_cast<std::uint64_t>(step) : 0;
}

void DumpFrame::read_bounds(Frame& frame) {
  const std::vector<std::string_view> head = words_of(line("its box"));
  if (head.size() > 6) throw bad("its box is tilted", "a box with right angles");
  for (std::size_t k = 3; k < head.size(); ++k) {
    if (head[k] == "xy") throw bad("its box is tilted", "a box with right angles");
    if (head[k] != "pp") throw bad(fmt::format("its box has boundaries {}", head[k]), "a periodic box, pp pp pp");
  }
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<std::string_view> words = words_of(line("the end of its box"));
    if (words.size() != 2) throw bad("a line of its box has not two numbers", "lower and upper bound");
    low_[axis] = number(words[0], "a bound of the box");
    frame.box[axis] = number(words[1], "a bound of the box") - low_[axis];
    if (!(frame.box[axis] > 0 && std::isfinite(frame.box[axis]))) {
      throw bad(fmt::format("its box has an edge of {:g}", frame.box[axis]), "finite edges above 0");
    }
  }
}

void DumpFrame::read_columns(std::string_view head) {
  constexpr std::string_view kHead = "ITEM: ATOMS ";
  if (!head.starts_with(kHead)) throw bad(fmt::format("\"{}\" stands before its bodies", head), "ITEM: ATOMS");
  names_ = words_of(head.substr(kHead.size()));
}

std::optional<std::vector<std::size_t>> DumpFrame::columns(std::initializer_list<std::string_view> names) const {
  std::vector<std::size_t> list;
  for (const std::string_view name : names) {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) return std::nullopt;
    list.push_back(static_cast<std::size_t>(found - names_.begin()));
  }
  return list;
}

void DumpFrame::read_position(const std::vector<std::string_view>& words, const Frame& frame, FrameBody& body) const {
  const auto scaled = columns({"xs", "ys", "zs"});
  const auto unwrapped = columns({"xu", "yu", "zu"});
  auto where = columns({"x", "y", "z"});
  if (!where) where = unwrapped ? unwrapped : scaled;
  if (!where) throw bad("has no positions", "columns x y z, xu yu zu or xs ys zs");
  for (int axis = 0; axis < 3; ++axis) {
    const double x = number(words[(*where)[static_cast<std::size_t>(axis)]], "a position");
    const double L = frame.box[axis];
    const double from_middle = where == scaled ? (x - 0.5) * L : x - (low_[axis] + 0.5 * L);
    const double away = std::round(from_middle / L);
    if (!(std::abs(away) < kMostImages)) throw bad(fmt::format("a body is at {:g}", x), "positions in the box");
    body.unwrapped[axis] = from_middle;
    body.position[axis] = from_middle - L * away;
  }
}

void DumpFrame::read_shape(const std::vector<std::string_view>& words, std::uint32_t type, Frame& frame,
                           FrameBody& body) {
  std::string key = std::to_string(type);
  std::vector<double> numbers;
  const auto diameters = columns({"shapex", "shapey", "shapez"});
  const auto roundness = columns({"SuperquadricRoundness.Phi", "SuperquadricRoundness.Theta"});
  for (const auto* list : {&diameters, &roundness}) {
    if (!diameters || !*list) continue;
    for (const std::size_t k : **list) {
      numbers.push_back(number(words[k], "a shape"));
      key += fmt::format(" {}", words[k]);
    }
  }
  const auto [found, fresh] = types_.try_emplace(key, static_cast<std::uint32_t>(types_.size()));
  body.type = found->second;
  if (!fresh) return;
  FrameType& out = frame.types.emplace_back();
  out.name = std::to_string(type);
  if (numbers.empty()) return;
  const Vector3d axes = 0.5 * Vector3d(numbers[0], numbers[1], numbers[2]);
  try {
    if (numbers.size() == 5 && (numbers[3] != 1 || numbers[4] != 1)) {
      out.shape = geom::Superellipsoid(axes, numbers[4], numbers[3]);
    } else {
      out.shape = geom::Ellipsoid(axes);
    }
  } catch (const std::invalid_argument& error) {
    throw bad(fmt::format("a body of type {}: {}", type, error.what()), "shapes of bodies");
  }
}

void DumpFrame::read_body(const std::vector<std::string_view>& words, Frame& frame) {
  FrameBody& body = frame.bodies.emplace_back();
  const auto get = [&](std::string_view name, double missing) {
    const auto column = columns({name});
    return column ? number(words[column->front()], "a column") : missing;
  };
  body.id = get("id", static_cast<double>(frame.bodies.size()));
  order_.emplace_back(body.id, frame.bodies.size() - 1);
  read_position(words, frame, body);
  if (const auto q = columns({"quatw", "quati", "quatj", "quatk"})) {
    Eigen::Vector4d x;
    for (int k = 0; k < 4; ++k) x[k] = number(words[(*q)[static_cast<std::size_t>(k)]], "an orientation");
    const double length = x.norm();
    if (!(std::abs(length - 1) <= kDumpQuaternionTolerance)) {
      throw bad(fmt::format("an orientation is a quaternion of length {:g}", length),
                fmt::format("1 within {:g}", kDumpQuaternionTolerance));
    }
    x /= length;
    body.rotation = geom::Pose::from_quaternion(x[0], x[1], x[2], x[3]).rotation();
  }
  if (const auto v = columns({"vx", "vy", "vz"})) {
    for (int k = 0; k < 3; ++k) body.velocity[k] = number(words[(*v)[static_cast<std::size_t>(k)]], "a velocity");
  }
  body.mass = get("mass", 1);
  const double type = get("type", 1);
  if (!(type >= 1 && type <= 1e6 && type == std::floor(type)))
    throw bad("a type is not a positive integer", "1 to 10^6");
  body.group = static_cast<std::uint32_t>(type);
  groups_.try_emplace(body.group, 0);
  read_shape(words, body.group, frame, body);
}

Frame DumpFrame::read() {
  Frame frame;
  read_head(frame);
  (void)line("its number of bodies");
  const double count = number(line("its number of bodies"), "the number of bodies");
  if (!(count >= 1 && count <= kMostBodies && count == std::floor(count))) {
    throw bad(fmt::format("has {:g} bodies", count), fmt::format("1 to {}", kMostBodies));
  }
  read_bounds(frame);
  read_columns(line("its bodies"));
  frame.orientations = columns({"quatw", "quati", "quatj", "quatk"}).has_value();
  frame.velocities = columns({"vx", "vy", "vz"}).has_value();
  frame.ids = columns({"id"}).has_value();
  for (auto k = static_cast<std::uint64_t>(count); k > 0; --k) {
    const std::vector<std::string_view> words = words_of(line("its last body"));
    if (words.size() != names_.size()) {
      throw bad(fmt::format("a body has {} columns of {}", words.size(), names_.size()), "a number a column");
    }
    read_body(words, frame);
  }
  std::uint32_t next = 0;
  for (auto& [type, group] : groups_) group = next++;
  std::stable_sort(order_.begin(), order_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t k = 1; k < order_.size(); ++k) {
    if (order_[k].first == order_[k - 1].first) {
      throw bad(fmt::format("two bodies have the id {:.17g}", order_[k].first), "an id of its own for each");
    }
  }
  std::vector<FrameBody> sorted;
  for (const auto& [id, body] : order_) {
    sorted.push_back(frame.bodies[body]);
    sorted.back().group = groups_.at(sorted.back().group);
  }
  frame.bodies = std::move(sorted);
  return frame;
}

constexpr std::string_view kBegin = "ITEM: TIMESTEP";

InputError foreign(const std::string& name) {
  return InputError(fmt::format("{}: is neither a GSD file nor a LAMMPS text dump; accepted: one of these", name));
}

/// Whether it is how a dump may begin.
bool begins_dump(std::string_view text) {
  return text.starts_with(kBegin) || text.starts_with(kTimeItem) || text.starts_with(kUnitsItem);
}

/// Where the line before the one at `at` > 0 begins.
std::size_t line_before(std::string_view text, std::size_t at) {
  const std::size_t end = at < 2 ? std::string_view::npos : text.rfind('\n', at - 2);
  return end == std::string_view::npos ? 0 : end + 1;
}

/// Where the frame begins whose time step is at `at`: what is said before it is a line and its value each.
std::size_t begin_of(std::string_view text, std::size_t at) {
  while (at > 0) {
    const std::size_t item = line_before(text, line_before(text, at));
    if (!text.substr(item).starts_with(kTimeItem) && !text.substr(item).starts_with(kUnitsItem)) break;
    if (text.substr(item).starts_with(kBegin)) break;
    at = item;
  }
  return at;
}

/// Calls f with the text of [begin, end) in pieces that each begin where the one before ended, and are longer by `more`
/// as far as there is more.
template <class F>
void in_pieces(const StoredBytes& bytes, std::uint64_t begin, std::uint64_t end, std::uint64_t more, F&& f) {
  constexpr std::uint64_t kPiece = std::uint64_t{1} << 20;
  for (std::uint64_t at = begin; at < end; at += kPiece) {
    const std::uint64_t size = std::min(kPiece, end - at);
    f(at, size, bytes.read(at, std::min(size + more, bytes.size() - at)));
  }
}

/// The longest text of what may stand before a frame's time step.
constexpr std::uint64_t kLongestPrelude = 1024;

}  // namespace

LammpsReader::LammpsReader(std::unique_ptr<StoredBytes> bytes, std::string name)
    : bytes_(std::move(bytes)), name_(std::move(name)), frames_(find_frames()) {
  // Only the last one can have been cut off.
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
      throw InputError(fmt::format("{}: byte {} is 0; accepted: a whole LAMMPS text dump", name_,
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

/// Whether it has a line for each of its bodies.
bool LammpsReader::is_whole(Place frame) const {
  constexpr std::uint64_t kLongestHead = 4096;
  const std::string head = bytes_->read(frame.begin, std::min(frame.end - frame.begin, kLongestHead));
  Lines lines(head);
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
  return DumpFrame(text, name_, k).read();
}

}  // namespace hardbody
