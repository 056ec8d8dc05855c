#include "trajectory/stored_trajectory.h"

#include "base/console.h"
#include "base/errors.h"
#include "base/find.h"
#include "base/shapes.h"
#include "io/text_file.h"
#include "trajectory/unwrapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace hardbody {
namespace {

/// Maximum number of bytes of all frames in memory.
constexpr double kMostMemory = 8e9;
constexpr double kMemoryOfABody = 700;
/// Relative difference of two sizes, masses or boxes that are regarded as the same, as text or 32-bit numbers.
constexpr double kSame = 1e-6;

/// Shortest unit of length in edges of the box.
constexpr double kLeastLength = 1e-6;

/// Lines about frames: each once, with the first frame to which it applies.
class Notices {
 public:
  void add(const std::vector<std::string>& lines, std::uint64_t frame) {
    for (const std::string& line : lines) {
      const std::string about = line.substr(0, line.find(':'));
      Notice* found = find_by(list_, &Notice::about, about);
      if (found == nullptr) {
        list_.push_back({about, line, frame, 1});
      } else {
        ++found->frames;
      }
    }
  }
  std::vector<std::string> lines(std::size_t frames) const {
    std::vector<std::string> lines;
    for (const Notice& n : list_) {
      std::string where;
      if (n.frames < frames) where = fmt::format(" (frame {}", n.frame);
      if (n.frames < frames && n.frames > 1) where += fmt::format(" and {} more", n.frames - 1);
      lines.push_back(n.text + where + (where.empty() ? "" : ")"));
    }
    return lines;
  }

 private:
  struct Notice {
    std::string about, text;
    std::uint64_t frame;
    std::size_t frames;
  };
  std::vector<Notice> list_;
};

/// Returns whether a frame's orientations are meaningful: for bodies whose shape has an orientation, or that are
/// rotated.
bool says_orientations(const Frame& frame) {
  const auto turned = [](const FrameBody& b) { return b.rotation != Eigen::Matrix3d::Identity(); };
  const auto turnable = [](const FrameType& t) { return t.shape && !ed::is_sphere(*t.shape); };
  return frame.orientations && (std::any_of(frame.bodies.begin(), frame.bodies.end(), turned) ||
                                std::any_of(frame.types.begin(), frame.types.end(), turnable));
}

/// Returns the body axis u: as in a run, the axis of revolution of bodies that are of revolution by shape and moments;
/// nullopt for others.
std::optional<int> axis_of(const Frame& frame, const FrameBody& body) {
  const std::optional<ed::BodyShape>& shape = frame.types[body.type].shape;
  const std::optional<int> axis = shape ? ed::symmetry_axis(*shape) : std::nullopt;
  return axis && frame.exact ? ed::symmetry_axis(frame.exact->species[body.type]) : axis;
}

class Reading {
 public:
  Reading(const TrajectoryReader& reader, const ReadingOptions& options)
      : reader_(reader), asked_(options), unwrapping_(reader.wraps_late()) {}

  StoredTrajectory read();

 private:
  InputError bad(std::uint64_t k, const std::string& what, const std::string& accepted) const {
    return InputError(fmt::format("{}: frame {}: {}; accepted: {}", reader_.name(), k, what, accepted));
  }
  std::vector<std::uint64_t> frames_with_positions();
  void check_memory(std::size_t frames) const;
  void read_groups(std::uint64_t k);
  void check_frame(const Frame& frame, std::uint64_t k) const;
  void check_body(const Frame& frame, std::uint64_t k, std::size_t n) const;
  void set_order(const Frame& frame);
  double time_of(const Frame& frame, std::uint64_t k) const;
  void check_time(double time, std::uint64_t k) const;
  void keep(const Frame& frame, double time, std::uint64_t k);
  void finish(std::size_t used);

  const TrajectoryReader& reader_;
  const ReadingOptions& asked_;
  StoredTrajectory result_;
  Frame first_;
  std::vector<std::size_t> first_order_;
  std::vector<std::size_t> order_;  ///< bodies of the current frame by their groups
  Unwrapping unwrapping_;
  Notices notices_;
  bool ids_ = true;
  std::uint64_t last_kept_ = 0;         ///< number in the file of the last frame in result_
  std::size_t known_orientations_ = 0;  ///< number of frames in which orientations are known
  std::size_t known_velocities_ = 0;
  bool say_orientations_ = false;
};

std::vector<std::uint64_t> Reading::frames_with_positions() {
  result_.in_file = static_cast<std::size_t>(reader_.frame_count());
  if (result_.in_file == 0) {
    throw InputError(fmt::format("{}: has no complete frame; accepted: a file with frames", reader_.name()));
  }
  std::vector<std::uint64_t> list;
  for (std::uint64_t k = 0; k < reader_.frame_count(); ++k) {
    if (reader_.has_positions(k)) list.push_back(k);
  }
  if (list.empty())
    throw InputError(fmt::format("{}: no frame has positions; accepted: frames with positions", reader_.name()));
  result_.without_positions = result_.in_file - list.size();
  return list;
}

void Reading::check_memory(std::size_t frames) const {
  const double bytes =
      static_cast<double>(first_.bodies.size()) * static_cast<double>(frames) / asked_.every * kMemoryOfABody;
  if (bytes <= kMostMemory) return;
  throw InputError(
      fmt::format("{}: {} frames of {} bodies take {:.0f} GB of memory; accepted: at most {:.0f} GB; "
                  "--every N uses only every N-th of them",
                  reader_.name(), frames, first_.bodies.size(), bytes / 1e9, kMostMemory / 1e9));
}

void Reading::set_order(const Frame& frame) {
  order_.resize(frame.bodies.size());
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::size_t a, std::size_t b) { return frame.bodies[a].group < frame.bodies[b].group; });
}

/// Determines the groups and the order of the bodies from the first frame, the file's k-th.
void Reading::read_groups(std::uint64_t k) {
  ed::StoredFramesOptions& options = result_.options;
  double volume = 0;
  double length = 0;  // of all that have an orientation, along u
  double oriented = 0;
  bool shapes = true;
  for (std::size_t n = 0; n < first_order_.size(); ++n) {
    const FrameBody& body = first_.bodies[first_order_[n]];
    const std::optional<ed::BodyShape>& shape = first_.types[body.type].shape;
    if (shape) volume += ed::volume(*shape);
    shapes = shapes && shape;
    const std::optional<int> axis = axis_of(first_, body);
    options.axis.push_back(axis.value_or(2));
    if (n == 0 || first_.bodies[first_order_[n - 1]].group != body.group)
      options.groups.push_back({0, axis ? 2 : 3, false});
    ++options.groups.back().number;
    if (!axis) options.groups.back().rotation_axes = 3;
    if (shape && ed::is_sphere(*shape)) continue;
    options.groups.back().oriented = true;
    if (shape) length += 2 * ed::half_extents(*shape)[axis.value_or(2)];
    oriented += 1;
  }
  options.length_known = shapes;
  options.axial_length = shapes && oriented > 0 ? length / oriented : 0;
  // Without the sizes of all bodies: as if they filled half of the box, so that the grids fit any unit of length.
  if (!shapes) volume = 0.5 * options.box * options.box * options.box;
  options.length = std::cbrt(volume / static_cast<double>(first_.bodies.size()) / (4 * std::numbers::pi / 3));
  if (options.length > kLeastLength * options.box) return;
  throw bad(
      k, fmt::format("its box has an edge of {:g}, its bodies have a mean radius of {:g}", options.box, options.length),
      fmt::format("an edge below {:g} times this length", 1 / kLeastLength));
}

/// Checks that body n of the order is the same as in the first frame.
void Reading::check_body(const Frame& frame, std::uint64_t k, std::size_t n) const {
  const FrameBody& body = frame.bodies[order_[n]];
  const FrameBody& before = first_.bodies[first_order_[n]];
  const char* accepted = "bodies that do not change";
  const std::string which = frame.ids ? fmt::format("body {:.17g}", body.id) : fmt::format("body {} of its type", n);
  const FrameType& type = frame.types[body.type];
  const FrameType& type_before = first_.types[before.type];
  const auto type_changed = [&](const std::string& body_text, const FrameType& now, const FrameType& then) {
    return bad(k,
               fmt::format("{} is of type {}, in the first frame of {}", body_text, one_line(now.name, 40),
                           one_line(then.name, 40)),
               accepted);
  };
  if (frame.ids && body.id != before.id) {
    // Bodies are sorted by type first: one of another type than before stands elsewhere.
    const FrameBody* now = find_by(frame.bodies, &FrameBody::id, before.id);
    const FrameBody* then = find_by(first_.bodies, &FrameBody::id, body.id);
    if (now != nullptr && now->group != before.group) {
      throw type_changed(fmt::format("body {:.17g}", now->id), frame.types[now->type], type_before);
    }
    if (then != nullptr && then->group != body.group) throw type_changed(which, type, first_.types[then->type]);
    throw bad(k, fmt::format("has body {:.17g} where the first frame has {:.17g}", body.id, before.id),
              "the same bodies in every frame");
  }
  if (body.group != before.group || type.name != type_before.name) throw type_changed(which, type, type_before);
  const std::optional<ed::BodyShape>& was = type_before.shape;
  if (type.shape.has_value() != was.has_value() || (was && !same_shape(*was, *type.shape, kSame, kSame))) {
    throw bad(k, fmt::format("{} has another shape or size than in the first frame", which), accepted);
  }
  if (!(std::abs(body.mass - before.mass) <= kSame * std::abs(before.mass))) {
    throw bad(k, fmt::format("{} has a mass of {:g}, in the first frame of {:g}", which, body.mass, before.mass),
              accepted);
  }
}

void Reading::check_frame(const Frame& frame, std::uint64_t k) const {
  if (const std::optional<std::string> why = not_a_cube(frame)) throw bad(k, *why, "a cubic box");
  if ((frame.box - first_.box).cwiseAbs().maxCoeff() > kSame * first_.box.x()) {
    throw bad(
        k, fmt::format("its box has an edge of {:.9g}, that of the first frame {:.9g}", frame.box.x(), first_.box.x()),
        "one box");
  }
  if ((frame.middle - first_.middle).cwiseAbs().maxCoeff() > kSame * first_.box.x() + kSame * first_.middle.norm()) {
    throw bad(k, "its box is not where that of the first frame is", "constant bounds");
  }
  if (frame.bodies.size() != first_.bodies.size()) {
    throw bad(k, fmt::format("has {} bodies, the first frame {}", frame.bodies.size(), first_.bodies.size()),
              "the same number");
  }
  for (std::size_t n = 0; n < order_.size(); ++n) check_body(frame, k, n);
}

double Reading::time_of(const Frame& frame, std::uint64_t k) const {
  if (asked_.time_step) return static_cast<double>(frame.step) * *asked_.time_step;
  if (std::isfinite(frame.time)) return frame.time;
  throw InputError(
      fmt::format("{}: frame {} has no time; accepted: --time-step, the time between two steps", reader_.name(), k));
}

void Reading::check_time(double time, std::uint64_t k) const {
  const std::vector<ed::StoredFrame>& before = result_.frames;
  if (std::isfinite(time) && (before.empty() || time > before.back().time)) return;
  const std::string than =
      before.empty() ? "" : fmt::format(", that of frame {} is {:.9g}", last_kept_, before.back().time);
  throw InputError(
      fmt::format("{}: time of frame {} is {:.9g}{}; accepted: finite times that rise", reader_.name(), k, time, than));
}

void Reading::keep(const Frame& frame, double time, std::uint64_t k) {
  check_time(time, k);
  last_kept_ = k;
  ed::StoredFrame& out = result_.frames.emplace_back();
  out.time = time;
  for (const std::size_t i : order_) {
    const FrameBody& body = frame.bodies[i];
    if (frame.orientations) out.rotation.push_back(body.rotation);
    if (frame.velocities) out.velocity.push_back(body.velocity);
  }
  result_.energy.push_back(frame.energy);
  result_.exact = frame.exact.has_value() && (result_.exact || result_.frames.size() == 1);
  known_orientations_ += frame.orientations ? 1 : 0;
  known_velocities_ += frame.velocities ? 1 : 0;
  say_orientations_ = say_orientations_ || says_orientations(frame);
}

/// Keeps the quantities that all frames contain, and the source of unwrapped positions.
void Reading::finish(std::size_t used) {
  const std::size_t count = result_.frames.size();
  result_.notices = notices_.lines(used);
  const auto partly = [&](const char* what, std::size_t known) {
    if (known == 0 || known == count) return;
    result_.notices.push_back(fmt::format("{}: known in {} of {} frames, not used", what, known, count));
  };
  if (say_orientations_) partly("orientations", known_orientations_);
  partly("velocities", known_velocities_);
  const bool orientations = say_orientations_ && known_orientations_ == count;
  const bool velocities = known_velocities_ == count;
  Unwrapping::Result unwrapped = unwrapping_.take();
  // Without ids a jump may be another body in the same line, and says nothing about images.
  const bool followed = ids_ || count == 1;
  if (followed && !unwrapped.notice.empty()) result_.notices.push_back(unwrapped.notice);
  for (std::size_t k = 0; k < count; ++k) {
    ed::StoredFrame& frame = result_.frames[k];
    if (!orientations) frame.rotation.clear();
    if (!velocities) frame.velocity.clear();
    frame.position = std::move(unwrapped.positions[k]);
  }
  if (followed) {
    result_.unwrapped_by = std::move(unwrapped.by);
    result_.not_unwrapped = std::move(unwrapped.reason);
  } else {
    result_.not_followed =
        "the file does not number its bodies (no column id), which need not be in the same order in "
        "every frame";
    result_.not_unwrapped = result_.not_followed;
  }
  result_.options.unwrapped = result_.not_unwrapped.empty();
  result_.options.same_bodies = result_.not_followed.empty();
}

StoredTrajectory Reading::read() {
  const std::vector<std::uint64_t> list = frames_with_positions();
  first_ = reader_.read(list[0]);
  check_memory(list.size());
  set_order(first_);
  first_order_ = order_;
  result_.options.box = first_.box.x();
  result_.options.longest_lag = asked_.longest_lag.value_or(0);
  read_groups(list[0]);
  const auto every = static_cast<std::size_t>(asked_.every);
  for (std::size_t n = 0; n < list.size(); ++n) {
    console().poll();
    const std::uint64_t k = list[n];
    const Frame frame = reader_.read(k);
    set_order(frame);
    check_frame(frame, k);
    ids_ = ids_ && frame.ids;
    notices_.add(frame.notices, k);
    const bool kept = n % every == 0;
    unwrapping_.add(frame, order_, kept);
    if (kept) keep(frame, list.size() == 1 ? 0 : time_of(frame, k), k);
  }
  finish(list.size());
  return std::move(result_);
}

}  // namespace

StoredTrajectory read_trajectory(const TrajectoryReader& reader, const ReadingOptions& options) {
  return Reading(reader, options).read();
}

}  // namespace hardbody
