#include "trajectory/gsd/frame_reader.h"

#include "base/errors.h"
#include "base/shapes.h"
#include "io/orientation.h"
#include "io/text_file.h"
#include "trajectory/gsd/type_shapes.h"

#include <ed/archive.h>

#include <Eigen/Geometry>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

using namespace gsd;
using ed::archive::Reader;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::uint32_t kMostTypes = 1'000'000;
constexpr std::uint64_t kMostInFrame = 10'000'000;
constexpr std::uint64_t kLongestTexts = std::uint64_t{1} << 26;  ///< bytes

}  // namespace

const GsdChunk* FrameReader::find(ArrayName name, std::uint64_t rows, std::uint32_t columns, GsdType type) const {
  const auto fits = [&](const GsdChunk& chunk) { return chunk.rows == rows && chunk.columns == columns; };
  const GsdChunk* chunk = file_.find(k_, name.text);
  if (chunk == nullptr) {
    chunk = file_.find(0, name.text);
    if (chunk == nullptr || !fits(*chunk)) return nullptr;
  }
  if (!fits(*chunk) || chunk->type != type) {
    throw bad(fmt::format("{} is {} x {} numbers of type {}", name.text, chunk->rows, chunk->columns,
                          static_cast<int>(chunk->type)),
              fmt::format("{} x {} of type {}", rows, columns, static_cast<int>(type)));
  }
  return chunk;
}

template <class T>
std::vector<T> FrameReader::numbers(ArrayName name, std::uint64_t rows, std::uint32_t columns) const {
  const GsdChunk* chunk = find(name, rows, columns, kTypeOf<T>);
  if (chunk == nullptr) return {};
  const std::string bytes = file_.read(*chunk);
  Reader reader(bytes);
  std::vector<T> result(bytes.size() / sizeof(T));
  for (T& x : result) reader(x);
  return result;
}

template <class T>
std::vector<double> FrameReader::finite(ArrayName name, std::uint64_t rows, std::uint32_t columns) const {
  std::vector<double> result;
  for (const T x : numbers<T>(name, rows, columns)) result.push_back(static_cast<double>(x));
  for (std::size_t k = 0; k < result.size(); ++k) {
    if (std::isfinite(result[k])) continue;
    throw bad(fmt::format("{} of body {} is {}", name.text, k / columns, result[k]), "finite numbers");
  }
  return result;
}

template <class T>
T FrameReader::scalar(ArrayName name, T missing) const {
  const std::vector<T> result = numbers<T>(name, 1, 1);
  return result.empty() ? missing : result[0];
}

/// Returns the rows of an array of texts.
std::vector<std::string> FrameReader::texts(ArrayName name) const {
  const GsdChunk* chunk = file_.find(k_, name.text);
  if (chunk == nullptr) chunk = file_.find(0, name.text);
  if (chunk == nullptr) return {};
  if (size_of(chunk->type) != 1) throw bad(fmt::format("{} is not text", name.text), "bytes");
  if (chunk->rows > kMostTypes) throw bad(fmt::format("{} has {} rows", name.text, chunk->rows), "at most 10^6");
  if (chunk->bytes() > kLongestTexts)
    throw bad(fmt::format("{} has {} bytes", name.text, chunk->bytes()), "at most 2^26");
  const std::string bytes = file_.read(*chunk);
  std::vector<std::string> result;
  for (std::size_t at = 0; at < bytes.size(); at += chunk->columns) {
    const std::string row = bytes.substr(at, chunk->columns);
    result.push_back(row.substr(0, std::min(row.find('\0'), row.size())));
  }
  return result;
}

void FrameReader::read_box(Frame& frame) const {
  const GsdChunk* dimensions = find(kDimensions, 1, 1, GsdType::uint8);
  if (dimensions != nullptr && file_.read(*dimensions)[0] != '\3') throw bad("is not of three dimensions", "three");
  std::vector<double> box = finite<float>(kBox, 6, 1);
  if (box.empty()) box = {1, 1, 1, 0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    frame.box[i] = box[static_cast<std::size_t>(i)];
    if (!(frame.box[i] > 0)) throw bad(fmt::format("its box has an edge of {}", frame.box[i]), "edges above 0");
  }
  frame.tilt = {box[3] * box[1], box[4] * box[2], box[5] * box[2]};  // the file contains ratios
}

std::optional<ed::BodyShape> FrameReader::own_shape(const std::string& row, const ed::BodyShape& known) const {
  if (!swept_polytope(known)) return read_own_type_shape(row, known);
  const auto found = shapes_.own_rows.find(row);
  if (found != shapes_.own_rows.end()) return found->second;
  return shapes_.own_rows.emplace(row, read_own_type_shape(row, known)).first->second;
}

void FrameReader::read_types(Frame& frame) const {
  std::vector<std::string> names = texts(kTypes);
  if (names.empty()) names = {"A"};
  const std::vector<std::string> shapes = texts(kTypeShapes);
  const std::vector<ed::Species> known = exact_ ? read_species() : std::vector<ed::Species>();
  std::string others;
  for (std::size_t k = 0; k < names.size(); ++k) {
    frame.types.push_back({names[k], std::nullopt, k < shapes.size() && shapes[k] != "{}" && !shapes[k].empty()});
    if (k >= shapes.size()) continue;
    try {
      if (k < known.size()) {
        frame.types[k].shape = own_shape(shapes[k], known[k].shape);
        continue;
      }
      auto found = shapes_.rows.find(shapes[k]);
      if (found == shapes_.rows.end()) found = shapes_.rows.emplace(shapes[k], read_type_shape(shapes[k])).first;
      if (found->second) {
        frame.types[k].shape = found->second->shape;
        frame.types[k].X_BS = found->second->X_BS;
      }
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: frame {}: the shape of type {}: {}", file_.name(), k_, k, error.what()));
    }
    if (frame.types[k].shape_given && !frame.types[k].shape && others.size() < kShownLength) {
      others += fmt::format(" {}", one_line(names[k], 20));
    }
  }
  if (!others.empty() && !exact_) {
    frame.notices.push_back(fmt::format(
        "shapes: those of types{} are not used; spheres, ellipsoids and convex polyhedra are, {{\"type\": \"Sphere\", "
        "\"diameter\": ..}}, {{\"type\": \"Ellipsoid\", \"a\": .., \"b\": .., \"c\": ..}}, {{\"type\": "
        "\"ConvexPolyhedron\", \"rounding_radius\": .., \"vertices\": [..]}}",
        others));
  }
}

/// Moves bodies to the frames of their shapes: the centre of mass and the principal axes of a polyhedron.
void FrameReader::move_to_shapes(Frame& frame) const {
  std::string moved;
  for (FrameType& type : frame.types) {
    if (!type.X_BS) continue;
    if (!frame.orientations) type.shape.reset();
    if (moved.size() < kShownLength) moved += fmt::format(" {}", one_line(type.name, 20));
  }
  if (moved.empty()) return;
  if (!frame.orientations) {
    frame.notices.push_back(fmt::format(
        "shapes: those of types{} are not used: their frames are not that of the principal axes, and orientations are "
        "not known",
        moved));
    return;
  }
  for (FrameBody& body : frame.bodies) {
    const std::optional<geom::Pose>& X_BS = frame.types[body.type].X_BS;
    if (!X_BS) continue;
    const Vector3d arm = body.rotation * X_BS->position();
    body.position += arm;
    body.unwrapped += arm;
    body.velocity += body.angular_velocity.cross(arm);
    body.rotation = body.rotation * X_BS->rotation();
    body.inertia.setZero();  // those of the file are about other axes
    if (frame.tilt.isZero(0)) (void)wrap(body.position, frame.box);
  }
  frame.notices.push_back(fmt::format(
      "shapes: bodies of types{} are moved to the centres of mass and principal axes of their polyhedra", moved));
}

void FrameReader::read_orientations(Frame& frame) const {
  // The first frame follows the schema: without orientations bodies are aligned.
  frame.orientations = k_ == 0 || knows(kOrientation);
  if (!frame.orientations) return;
  const std::vector<double> orientation = finite<float>(kOrientation, frame.bodies.size(), 4);
  FrameOrientations orientations;
  for (std::size_t i = 0; 4 * i < orientation.size(); ++i) {
    const Eigen::Vector4d q = Eigen::Map<const Eigen::Vector4d>(orientation.data() + 4 * i);
    const std::optional<Matrix3d> rotation = orientations.rotation(q);
    if (!rotation) {
      throw bad(fmt::format("the orientation of body {} {}", i, FrameOrientations::fault(q)),
                FrameOrientations::accepted());
    }
    frame.bodies[i].rotation = *rotation;
  }
  if (std::optional<std::string> notice = orientations.notice()) frame.notices.push_back(std::move(*notice));
}

/// Sets spheres of the stored diameters if no shape is given and no body has an orientation of its own.
void FrameReader::read_diameters(Frame& frame) const {
  const auto bare = [](const FrameType& type) { return !type.shape_given; };
  if (std::none_of(frame.types.begin(), frame.types.end(), bare)) return;
  const std::vector<double> diameter = finite<float>(ArrayName("particles/diameter"), frame.bodies.size(), 1);
  if (diameter.empty()) return;
  if (file_.find(0, kNameTexts[kOrientation]) != nullptr || file_.stored_later(kNameTexts[kOrientation])) {
    frame.notices.emplace_back(
        "particles/diameter: not used, because bodies with orientations are not spheres; shapes are read from "
        "particles/type_shapes");
    return;
  }
  SphereTypes types(frame.types);
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    FrameBody& body = frame.bodies[i];
    if (!bare(frame.types[body.type])) continue;
    try {
      body.type = types.of(body.type, 0.5 * diameter[i]);
    } catch (const std::invalid_argument& error) {
      throw bad(fmt::format("particles/diameter of body {}: {}", i, one_line(error.what())), "diameters of bodies");
    }
  }
  frame.types = types.take();
  frame.notices.emplace_back("particles/diameter: bodies are treated as spheres of these diameters");
}

void FrameReader::read_bodies(Frame& frame) const {
  const auto number = std::uint64_t{scalar<std::uint32_t>(kNumber, 0)};
  if (number == 0) throw bad("has no bodies", "at least 1");
  if (number > kMostInFrame) throw bad(fmt::format("has {} bodies", number), "at most 10^7");
  const std::vector<double> position = finite<float>(kPosition, number, 3);
  if (position.empty()) throw bad(fmt::format("has no positions of its {} bodies", number), kNameTexts[kPosition]);
  frame.images = knows(kImage);
  if (frame.images) frame.unwrapped_by = "image flags";
  frame.ids = true;
  const auto image = frame.images ? numbers<std::int32_t>(kImage, number, 3) : std::vector<std::int32_t>();
  frame.zero_images = frame.images && std::all_of(image.begin(), image.end(), [](std::int32_t n) { return n == 0; });
  frame.bodies.resize(number);
  for (std::size_t i = 0; i < number; ++i) {
    FrameBody& body = frame.bodies[i];
    body.id = static_cast<double>(i);
    body.position = body.unwrapped = {position[3 * i], position[3 * i + 1], position[3 * i + 2]};
    if (frame.tilt.isZero(0) && !wrap(body.position, frame.box)) {
      const Vector3d& x = body.unwrapped;
      throw bad(fmt::format("body {} is at {:g}, {:g}, {:g}", i, x.x(), x.y(), x.z()), "positions in the box");
    }
    if (!image.empty()) {
      body.unwrapped += frame.box.cwiseProduct(Vector3d(image[3 * i], image[3 * i + 1], image[3 * i + 2]));
    }
  }
}

void FrameReader::read_motion(Frame& frame) const {
  const std::uint64_t number = frame.bodies.size();
  const std::vector<std::uint32_t> type = numbers<std::uint32_t>(kTypeId, number, 1);
  const std::vector<std::uint32_t> group = numbers<std::uint32_t>(kGroup, number, 1);
  const std::vector<double> mass = finite<float>(kMass, number, 1);
  const std::vector<double> inertia = finite<float>(kInertia, number, 3);
  frame.velocities = knows(kVelocity);
  frame.angular_velocities = frame.angular_momenta = frame.orientations && knows(kAngularMomentum);
  const auto velocity = frame.velocities ? finite<float>(kVelocity, number, 3) : std::vector<double>();
  const auto angmom = frame.angular_velocities ? finite<float>(kAngularMomentum, number, 4) : std::vector<double>();
  // An angular momentum is twice the product of the quaternion, with the sign that it has in the file, and L.
  const auto orientation = angmom.empty() ? std::vector<double>() : finite<float>(kOrientation, number, 4);
  for (std::size_t i = 0; i < number; ++i) {
    FrameBody& body = frame.bodies[i];
    if (!type.empty()) body.type = type[i];
    if (body.type >= frame.types.size()) {
      throw bad(fmt::format("body {} is of type {}", i, body.type), fmt::format("below {}", frame.types.size()));
    }
    body.group = group.empty() ? body.type : group[i];
    if (!mass.empty()) body.mass = mass[i];
    if (!inertia.empty()) body.inertia = {inertia[3 * i], inertia[3 * i + 1], inertia[3 * i + 2]};
    if (!velocity.empty()) body.velocity = {velocity[3 * i], velocity[3 * i + 1], velocity[3 * i + 2]};
    if (angmom.empty()) continue;
    const double* p = angmom.data() + 4 * i;
    Quaterniond q = Quaterniond::Identity();
    if (!orientation.empty()) {
      const double* o = orientation.data() + 4 * i;
      q = Quaterniond(o[0], o[1], o[2], o[3]).normalized();
    }
    const Vector3d L = 0.5 * (q.conjugate() * Quaterniond(p[0], p[1], p[2], p[3])).vec();
    Vector3d omega = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) omega[k] = body.inertia[k] > 0 ? L[k] / body.inertia[k] : 0;
    body.angular_velocity = body.rotation * omega;
    body.angular_momentum = body.rotation * L;
  }
}

Frame FrameReader::read() {
  Frame frame;
  frame.step = scalar<std::uint64_t>(kStep, 0);
  frame.time = logged(kTime);
  frame.energy = logged(kEnergy);
  frame.Z = logged(kZ);
  frame.S = logged(kS);
  read_box(frame);
  read_types(frame);
  read_bodies(frame);
  read_orientations(frame);
  read_motion(frame);
  read_diameters(frame);
  move_to_shapes(frame);
  return frame;
}

std::vector<double> FrameReader::exact(Name name, std::uint64_t rows, std::uint32_t columns) const {
  std::vector<double> result = finite<double>(name, rows, columns);
  if (result.empty()) throw bad(fmt::format("{} is missing", kNameTexts[name]), "a complete frame of hardbody");
  return result;
}

ShapeNumbers FrameReader::shape_numbers(const double* row, std::uint32_t columns) const {
  const auto is_kind = [&](ShapeKind kind) { return row[0] == static_cast<double>(kind); };
  const auto* kind = std::find_if(kShapeKinds.begin(), kShapeKinds.end(), is_kind);
  if (kind == kShapeKinds.end()) throw std::invalid_argument("an unknown kind of shape");
  ShapeNumbers numbers{*kind, {row[1], row[2], row[3]}};
  if (has_semi_axes(*kind)) {
    numbers.exponents = {row[4], row[5]};
    return numbers;
  }
  numbers.rounding = row[4];
  const std::uint32_t most = (columns - kSpeciesColumns) / 3;
  if (!(row[5] >= 0 && row[5] <= static_cast<double>(most)))
    throw std::invalid_argument("more vertices than there are columns for");
  for (std::uint32_t v = 0; v < static_cast<std::uint32_t>(row[5]); ++v) {
    const double* x = row + kSpeciesColumns + std::size_t{3} * v;
    numbers.vertices.emplace_back(x[0], x[1], x[2]);
  }
  return numbers;
}

std::vector<ed::Species> FrameReader::read_species() const {
  const GsdChunk* chunk = file_.find(k_, kNameTexts[kExactSpecies]);
  const bool constant = chunk == nullptr || k_ == 0;
  if (constant && shapes_.species) return *shapes_.species;
  if (chunk == nullptr) chunk = file_.find(0, kNameTexts[kExactSpecies]);
  const std::uint64_t rows = chunk == nullptr ? 0 : chunk->rows;
  if (rows == 0 || rows > kMostTypes) throw bad(fmt::format("has {} species", rows), "1 to 10^6");
  const std::uint32_t columns = std::max(kSpeciesColumns, chunk->columns);
  const std::vector<double> numbers = exact(kExactSpecies, rows, columns);
  std::vector<ed::Species> list;
  for (std::size_t k = 0; k < rows; ++k) {
    const double* row = numbers.data() + k * columns;
    ed::Species& species = list.emplace_back();
    try {
      species.shape = make_body_shape(shape_numbers(row, columns));
      species.mass = row[6];
      species.inertia = {row[7], row[8], row[9]};
      species.spins = row[10] != 0;
      ed::check_species(species);
    } catch (const std::invalid_argument& error) {
      throw bad(fmt::format("species {}: {}", k, one_line(error.what())), "a species of hardbody");
    }
  }
  if (constant) shapes_.species = list;
  return list;
}

ed::System FrameReader::read_exact() {
  ed::System system;
  system.box = exact(kExactBox, 1, 1)[0];
  if (!(system.box > 0)) throw bad(fmt::format("its box has edges of {:g}", system.box), "a positive number");
  system.species = read_species();
  const auto number = std::uint64_t{scalar<std::uint32_t>(kNumber, 0)};
  std::vector<std::uint32_t> type = numbers<std::uint32_t>(kTypeId, number, 1);
  const std::vector<double> position = exact(kExactPosition, number, 3);
  const std::vector<double> rotation = exact(kExactRotation, number, 9);
  const std::vector<double> velocity = exact(kExactVelocity, number, 3);
  const std::vector<double> omega = exact(kExactAngularVelocity, number, 3);
  type.resize(number, 0);  // the schema's default, which other writers leave out
  for (std::size_t i = 0; i < number; ++i) {
    ed::Body& body = system.bodies.emplace_back();
    body.position = Eigen::Map<const Vector3d>(position.data() + 3 * i);
    body.rotation = Eigen::Map<const Matrix3d>(rotation.data() + 9 * i).transpose();
    body.velocity = Eigen::Map<const Vector3d>(velocity.data() + 3 * i);
    body.angular_velocity = Eigen::Map<const Vector3d>(omega.data() + 3 * i);
    body.species = static_cast<int>(type[i]);
    if (type[i] >= system.species.size()) {
      throw bad(fmt::format("body {} is of type {}", i, type[i]), fmt::format("below {}", system.species.size()));
    }
    // At most rounding outside its box.
    if (!(body.position.cwiseAbs().maxCoeff() <= 0.5 * system.box * (1 + 1e-12))) {
      throw bad(fmt::format("body {} is outside the box", i), "a complete frame of hardbody");
    }
    try {
      (void)geom::Pose(body.rotation, body.position);
    } catch (const std::invalid_argument& error) {
      throw bad(fmt::format("body {}: {}", i, one_line(error.what())), "positions and rotations");
    }
  }
  return system;
}

}  // namespace hardbody
