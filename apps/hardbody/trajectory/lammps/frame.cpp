#include "trajectory/lammps/frame.h"

#include "base/errors.h"
#include "base/number_text.h"
#include "base/shapes.h"
#include "io/orientation.h"
#include "io/text_file.h"
#include "trajectory/lammps/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Vector3d;
using Words = std::vector<std::string_view>;

constexpr std::uint64_t kMostBodiesOfFrame = 100'000'000;
/// Accepted deviation, in edges, of a stored unwrapped position from the wrapped one plus a whole number of edges, in
/// addition to the rounding of six digits.
constexpr double kWholeEdges = 1e-3;
constexpr double kSixDigits = 1e-5;

/// Returns whether the position along an axis, the wrapped one if there is one, is in edges of the box.
bool is_scaled(const DumpColumns::Axis& axis) {
  return !axis.wrapped && (axis.scaled || (!axis.unwrapped && axis.unwrapped_scaled));
}

/// Frame of a dump, read line by line.
class DumpFrame {
 public:
  DumpFrame(std::string_view text, const std::string& name, std::uint64_t k) : lines_(text), name_(name), k_(k) {}
  Frame read();

 private:
  InputError bad(const std::string& what, const std::string& accepted) const {
    return InputError(fmt::format("{}: frame {}: {}; accepted: {}", name_, k_, one_line(what, 160), accepted));
  }
  std::string_view line(const char* what) {
    const std::optional<std::string_view> found = lines_.next();
    if (!found) throw bad(fmt::format("ends before {}", what), "a complete LAMMPS text dump");
    return *found;
  }
  double number(std::string_view word, const char* what) const {
    const std::optional<double> value = finite_number(word);
    if (!value) throw bad(fmt::format("{} is \"{}\"", what, word), "a finite number");
    return *value;
  }

  void read_head();
  void read_bounds();
  void set_bounds(const std::array<std::array<double, 4>, 3>& rows, std::size_t columns);
  void read_columns(std::string_view head);
  void check_tilted_columns();
  void read_body(const Words& words);
  void read_position(const Words& words, FrameBody& body);
  void read_orientation(const Words& words, FrameBody& body);
  void read_motion(const Words& words, FrameBody& body);
  void read_shape(const Words& words, std::uint32_t type, FrameBody& body);
  std::optional<ed::BodyShape> shape_of(const std::vector<double>& numbers, const FrameBody& body) const;
  void set_angular_velocities();
  void sort_bodies();

  /// Returns the name of the current body in a message.
  std::string label(const FrameBody& body) const {
    return columns_->id ? fmt::format("body {:.17g}", body.id) : fmt::format("the body in line {:g}", body.id);
  }
  /// Returns the number in a column of the current body.
  double cell(const Words& words, std::size_t column, const FrameBody& body) const {
    const std::optional<double> value = finite_number(words[column]);
    if (value) return *value;
    throw bad(fmt::format("{} of {} is \"{}\"", columns_->names[column], label(body), words[column]),
              "a finite number");
  }
  Vector3d three(const Words& words, const std::array<std::size_t, 3>& columns, const FrameBody& body) const {
    return {cell(words, columns[0], body), cell(words, columns[1], body), cell(words, columns[2], body)};
  }

  DumpLines lines_;
  const std::string& name_;
  std::uint64_t k_;
  Frame frame_;
  Vector3d low_ = Vector3d::Zero();
  std::optional<DumpColumns> columns_;
  bool tilted_scale_ = false;  ///< positions are scaled to a tilted box
  FrameOrientations orientations_;
  std::vector<Vector3d> angular_momentum_;         ///< angular momentum of each body, in the order of the lines
  std::map<std::uint32_t, std::uint32_t> groups_;  ///< groups by type
  std::map<std::string, std::uint32_t> types_;     ///< types by type and shape, as text
};

void DumpFrame::read_head() {
  std::string_view item = line("its time step");
  for (; item == kTimeItem || item == kUnitsItem; item = line("its time step")) {
    const std::string_view value = line("its time step");
    if (item == kTimeItem) frame_.time = number(value, "the time");
  }
  const double step = number(line("its time step"), "the time step");
  // Beyond 2^53 two steps may be the same double.
  if (!(step >= 0 && step <= 9007199254740992.0 && step == std::floor(step))) {
    throw bad(fmt::format("its time step is {:.17g}", step), "an integer from 0 to 2^53");
  }
  frame_.step = static_cast<std::uint64_t>(step);
}

void DumpFrame::read_bounds() {
  const Words head = words_of(line("its box"));
  Words rest(head.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(head.size(), 3)), head.end());
  std::size_t columns = 2;
  const auto take = [&](const Words& begin, std::size_t numbers) {
    if (rest.size() < begin.size() || !std::equal(begin.begin(), begin.end(), rest.begin())) return;
    rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(begin.size()));
    columns = numbers;
  };
  take({"xy", "xz", "yz"}, 3);
  take({"abc", "origin"}, 4);
  for (const std::string_view word : rest) {
    if (word != "pp") throw bad(fmt::format("its box has boundaries {}", word), "a periodic box, pp pp pp");
  }
  std::array<std::array<double, 4>, 3> rows{};
  for (std::array<double, 4>& row : rows) {
    const Words words = words_of(line("the end of its box"));
    if (words.size() != columns) {
      throw bad(fmt::format("a line of its box has {} numbers", words.size()),
                columns == 2   ? "lower and upper bound"
                : columns == 3 ? "lower and upper bound and a tilt"
                               : "an edge's three numbers and one of the origin");
    }
    for (std::size_t k = 0; k < columns; ++k) row[k] = number(words[k], "a bound of the box");
  }
  set_bounds(rows, columns);
}

/// Sets the box. `columns`: 2, bounds; 3, bounds of the box around a tilted one, and a tilt; 4, edges as vectors, and
/// the origin.
void DumpFrame::set_bounds(const std::array<std::array<double, 4>, 3>& rows, std::size_t columns) {
  if (columns == 4) {
    const bool tilted =
        rows[0][1] != 0 || rows[0][2] != 0 || rows[1][0] != 0 || rows[1][2] != 0 || rows[2][0] != 0 || rows[2][1] != 0;
    if (tilted) {
      throw bad("its box is a general triclinic one (abc origin)",
                "edges along x, y and z, as a restricted box has them");
    }
  }
  if (columns == 3) frame_.tilt = {rows[0][2], rows[1][2], rows[2][2]};
  const double xy = frame_.tilt.x();
  const double xz = frame_.tilt.y();
  const double yz = frame_.tilt.z();
  const Vector3d below(std::min({0.0, xy, xz, xy + xz}), std::min(0.0, yz), 0);
  const Vector3d above(std::max({0.0, xy, xz, xy + xz}), std::max(0.0, yz), 0);
  for (int axis = 0; axis < 3; ++axis) {
    const std::array<double, 4>& row = rows[static_cast<std::size_t>(axis)];
    low_[axis] = columns == 4 ? row[3] : row[0] - below[axis];
    frame_.box[axis] = columns == 4 ? row[static_cast<std::size_t>(axis)] : row[1] - above[axis] - low_[axis];
    if (!(frame_.box[axis] > 0 && std::isfinite(frame_.box[axis]))) {
      throw bad(fmt::format("its box has an edge of {:g}", frame_.box[axis]), "finite edges above 0");
    }
    frame_.middle[axis] = low_[axis] + 0.5 * frame_.box[axis];
  }
}

void DumpFrame::read_columns(std::string_view head) {
  constexpr std::string_view kHead = "ITEM: ATOMS ";
  if (!head.starts_with(kHead)) throw bad(fmt::format("\"{}\" precedes its bodies", head), "ITEM: ATOMS");
  columns_.emplace(words_of(head.substr(kHead.size())));
  for (const DumpColumns::Axis& axis : columns_->axes) {
    if (!axis.wrapped && !axis.scaled && !axis.unwrapped && !axis.unwrapped_scaled) {
      throw bad("has no positions", "columns x y z, xu yu zu, xs ys zs or xsu ysu zsu");
    }
  }
  if (!frame_.tilt.isZero(0)) check_tilted_columns();
  frame_.ids = columns_->id.has_value();
  frame_.images = columns_->unwrapped() && frame_.tilt.isZero(0);
  if (frame_.images) frame_.unwrapped_by = columns_->unwrapped_columns() ? "unwrapped columns" : "image flags";
  const auto by_image = [](const DumpColumns::Axis& axis) { return !axis.unwrapped && !axis.unwrapped_scaled; };
  frame_.zero_images = frame_.images && std::all_of(columns_->axes.begin(), columns_->axes.end(), by_image);
  frame_.orientations = columns_->quaternion.has_value();
  frame_.velocities = columns_->velocity.has_value();
  frame_.angular_velocities = columns_->angular_velocity.has_value();
  frame_.notices = columns_->notices;
}

/// Throws if positions are mixed: scaled ones are along the edges of a tilted box, others along the axes.
void DumpFrame::check_tilted_columns() {
  const auto& axes = columns_->axes;
  tilted_scale_ = is_scaled(axes[0]);
  for (const DumpColumns::Axis& axis : axes) {
    if (is_scaled(axis) == tilted_scale_) continue;
    throw bad("has scaled and other positions in a tilted box", "columns x y z, xu yu zu, xs ys zs or xsu ysu zsu");
  }
}

void DumpFrame::read_position(const Words& words, FrameBody& body) {
  const auto take = [&](DumpColumns::Column plain, DumpColumns::Column scaled, int axis) -> std::optional<double> {
    const double L = frame_.box[axis];
    if (plain) return cell(words, *plain, body) - (low_[axis] + 0.5 * L);
    if (scaled) return (cell(words, *scaled, body) - 0.5) * L;
    return std::nullopt;
  };
  const auto far_away = [&](double x) {
    return bad(fmt::format("{} is at {:g}", label(body), x), "positions in the box");
  };
  for (int axis = 0; axis < 3; ++axis) {
    const DumpColumns::Axis& columns = columns_->axes[static_cast<std::size_t>(axis)];
    const double L = frame_.box[axis];
    const std::optional<double> wrapped = take(columns.wrapped, columns.scaled, axis);
    std::optional<double> unwrapped = take(columns.unwrapped, columns.unwrapped_scaled, axis);
    if (wrapped && !(std::abs(*wrapped) < kMostImages * L)) throw far_away(*wrapped);
    if (unwrapped && !(std::abs(*unwrapped) < kMostImages * L)) throw far_away(*unwrapped);
    if (wrapped && unwrapped && frame_.tilt.isZero(0)) {
      const double edges = (*unwrapped - *wrapped) / L;
      if (std::abs(edges - std::round(edges)) > kWholeEdges + kSixDigits * std::abs(*unwrapped / L)) {
        throw bad(fmt::format("wrapped and unwrapped {} of {} are {:g} edges of the box apart", "xyz"[axis],
                              label(body), edges),
                  "a whole number of edges");
      }
    }
    if (!unwrapped && wrapped && columns.image) {
      const double image = cell(words, *columns.image, body);
      if (!(std::abs(image) < kMostImages && image == std::floor(image))) {
        throw bad(fmt::format("i{} of {} is {:g}", "xyz"[axis], label(body), image), "an integer");
      }
      unwrapped = *wrapped + image * L;
      frame_.zero_images = frame_.zero_images && image == 0;
    }
    body.position[axis] = wrapped ? *wrapped : *unwrapped;
    body.unwrapped[axis] = frame_.images ? *unwrapped : body.position[axis];
    // If another axis is wrapped, so is this one: the file does not determine the paths of bodies.
    if (!frame_.images && !wrapped) body.unwrapped[axis] -= L * std::round(body.unwrapped[axis] / L);
  }
  if (tilted_scale_) {
    const Vector3d edges = body.position.cwiseQuotient(frame_.box);
    body.position.x() += edges.y() * frame_.tilt.x() + edges.z() * frame_.tilt.y();
    body.position.y() += edges.z() * frame_.tilt.z();
  }
  if (!frame_.tilt.isZero(0)) body.unwrapped = body.position;
  if (frame_.tilt.isZero(0) && !wrap(body.position, frame_.box)) throw far_away(body.unwrapped.cwiseAbs().maxCoeff());
}

void DumpFrame::read_orientation(const Words& words, FrameBody& body) {
  if (!columns_->quaternion) return;
  Eigen::Vector4d q;
  for (int k = 0; k < 4; ++k) q[k] = cell(words, (*columns_->quaternion)[static_cast<std::size_t>(k)], body);
  const std::optional<Eigen::Matrix3d> rotation = orientations_.rotation(q);
  if (!rotation) {
    throw bad(fmt::format("the orientation of {} {}", label(body), FrameOrientations::fault(q)),
              FrameOrientations::accepted());
  }
  body.rotation = *rotation;
}

void DumpFrame::read_motion(const Words& words, FrameBody& body) {
  if (columns_->mass) body.mass = cell(words, *columns_->mass, body);
  if (columns_->velocity) body.velocity = three(words, *columns_->velocity, body);
  if (columns_->angular_velocity) body.angular_velocity = three(words, *columns_->angular_velocity, body);
  if (columns_->angular_momentum) angular_momentum_.push_back(three(words, *columns_->angular_momentum, body));
}

std::optional<ed::BodyShape> DumpFrame::shape_of(const std::vector<double>& numbers, const FrameBody& body) const {
  const Vector3d axes = 0.5 * Vector3d(numbers[0], numbers[1], numbers[2]);
  if (axes.isZero(0)) return std::nullopt;  // points, in LAMMPS' convention
  try {
    const bool round = numbers.size() != 5 || (numbers[3] == 1 && numbers[4] == 1);
    if (round) return make_body_shape({ShapeKind::ellipsoid, axes});
    return make_body_shape({ShapeKind::superellipsoid, axes, {numbers[4], numbers[3]}});
  } catch (const std::invalid_argument& error) {
    throw bad(fmt::format("shape of {}: {}", label(body), error.what()), "shapes of bodies");
  }
}

void DumpFrame::read_shape(const Words& words, std::uint32_t type, FrameBody& body) {
  std::string key = std::to_string(type);
  std::vector<double> numbers;
  const auto add = [&](std::size_t column) {
    numbers.push_back(cell(words, column, body));
    key += fmt::format(" {}", words[column]);
  };
  if (columns_->diameters) {
    for (const std::size_t column : *columns_->diameters) add(column);
    if (columns_->roundness) {
      for (const std::size_t column : *columns_->roundness) add(column);
    }
  } else if (columns_->radius || columns_->diameter) {
    add(columns_->radius ? *columns_->radius : *columns_->diameter);
    numbers.assign(3, (columns_->radius ? 2 : 1) * numbers[0]);
  }
  const auto [found, fresh] = types_.try_emplace(key, static_cast<std::uint32_t>(types_.size()));
  body.type = found->second;
  if (!fresh) return;
  FrameType& out = frame_.types.emplace_back();
  out.name = std::to_string(type);
  if (!numbers.empty()) out.shape = shape_of(numbers, body);
}

void DumpFrame::read_body(const Words& words) {
  FrameBody& body = frame_.bodies.emplace_back();
  body.id = static_cast<double>(frame_.bodies.size());
  if (columns_->id) {
    const std::optional<double> id = finite_number(words[*columns_->id]);
    if (!id) throw bad(fmt::format("an id is \"{}\"", words[*columns_->id]), "a finite number");
    body.id = *id;
  }
  read_position(words, body);
  read_orientation(words, body);
  read_motion(words, body);
  const double type = columns_->type ? cell(words, *columns_->type, body) : 1;
  if (!(type >= 1 && type <= 1e6 && type == std::floor(type))) {
    throw bad(fmt::format("the type of {} is {:g}", label(body), type), "an integer, 1 to 10^6");
  }
  body.group = static_cast<std::uint32_t>(type);
  groups_.try_emplace(body.group, 0);
  read_shape(words, body.group, body);
}

/// Computes angular velocities from stored angular momenta, assuming homogeneous bodies.
void DumpFrame::set_angular_velocities() {
  if (!columns_->angular_momentum || columns_->angular_velocity) return;
  frame_.angular_momenta = frame_.orientations;
  for (std::size_t i = 0; i < frame_.bodies.size(); ++i) frame_.bodies[i].angular_momentum = angular_momentum_[i];
  const auto shape = [](const FrameType& type) { return type.shape.has_value(); };
  const auto massive = [](const FrameBody& body) { return body.mass > 0; };
  // If all bodies are alike, the mass is one unknown factor of all.
  const bool masses = columns_->mass || frame_.types.size() == 1;
  if (!masses || !frame_.orientations || !std::all_of(frame_.types.begin(), frame_.types.end(), shape) ||
      !std::all_of(frame_.bodies.begin(), frame_.bodies.end(), massive)) {
    frame_.notices.emplace_back(
        "columns angmomx angmomy angmomz: not used; angular velocities follow from them only with mass, orientation "
        "and "
        "shape: mass, quatw quati quatj quatk, shapex shapey shapez");
    return;
  }
  if (!columns_->mass) {
    frame_.notices.emplace_back(
        "columns angmomx angmomy angmomz: treated as those of bodies of mass 1, because there is no mass");
  }
  std::vector<Vector3d> inertia;  // moments for mass 1
  for (const FrameType& type : frame_.types) inertia.push_back(ed::uniform_species(*type.shape).inertia);
  for (std::size_t i = 0; i < frame_.bodies.size(); ++i) {
    FrameBody& body = frame_.bodies[i];
    const Vector3d along_axes = body.rotation.transpose() * angular_momentum_[i];
    body.angular_velocity = body.rotation * along_axes.cwiseQuotient(body.mass * inertia[body.type]);
    if (!body.angular_velocity.allFinite()) {
      throw bad(fmt::format("{} has an infinite angular velocity", label(body)), "finite ones");
    }
  }
  frame_.angular_velocities = true;
}

/// Sorts the bodies by their ids, and numbers the groups.
void DumpFrame::sort_bodies() {
  std::stable_sort(frame_.bodies.begin(), frame_.bodies.end(),
                   [](const FrameBody& a, const FrameBody& b) { return a.id < b.id; });
  const auto same = [](const FrameBody& a, const FrameBody& b) { return a.id == b.id; };
  const auto twice = std::adjacent_find(frame_.bodies.begin(), frame_.bodies.end(), same);
  if (twice != frame_.bodies.end()) {
    throw bad(fmt::format("two bodies have the id {:.17g}", twice->id), "a different id for each");
  }
  std::uint32_t next = 0;
  for (auto& [type, group] : groups_) group = next++;
  for (FrameBody& body : frame_.bodies) body.group = groups_.at(body.group);
}

Frame DumpFrame::read() {
  read_head();
  (void)line("its number of bodies");
  const double count = number(line("its number of bodies"), "the number of bodies");
  if (!(count >= 1 && count <= kMostBodiesOfFrame && count == std::floor(count))) {
    throw bad(fmt::format("has {:g} bodies", count), fmt::format("1 to {}", kMostBodiesOfFrame));
  }
  read_bounds();
  read_columns(line("its bodies"));
  for (auto k = static_cast<std::uint64_t>(count); k > 0; --k) {
    const Words words = words_of(line("its last body"));
    if (words.size() != columns_->names.size()) {
      throw bad(fmt::format("a body has {} columns of {}", words.size(), columns_->names.size()), "a number a column");
    }
    read_body(words);
  }
  set_angular_velocities();
  if (std::optional<std::string> notice = orientations_.notice()) frame_.notices.push_back(std::move(*notice));
  sort_bodies();
  return std::move(frame_);
}

}  // namespace

Frame read_dump_frame(std::string_view text, const std::string& name, std::uint64_t k) {
  return DumpFrame(text, name, k).read();
}

}  // namespace hardbody
