#include "base/shapes.h"
#include "trajectory/gsd/frames.h"
#include "trajectory/gsd/schema.h"

#include "base/version.h"
#include "io/text_file.h"
#include "trajectory/gsd/type_shapes.h"

#include <ed/archive.h>

#include <Eigen/Geometry>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

using namespace gsd;
using ed::archive::Writer;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::uint32_t kSchemaVersion = 0x00010004;

template <class T>
GsdArray array_of(Name name, const std::vector<T>& numbers, std::uint32_t columns = 1) {
  Writer writer;
  for (const T& x : numbers) writer(x);
  return {name, kTypeOf<T>, numbers.size() / columns, columns, writer.take()};
}

/// Returns an array with one row for each body: the numbers that `get` returns.
template <class T, class Get>
GsdArray body_array(Name name, const Frame& frame, std::uint32_t columns, const Get& get) {
  std::vector<T> numbers;
  numbers.reserve(frame.bodies.size() * columns);
  for (const FrameBody& body : frame.bodies) {
    const auto values = get(body);
    for (std::uint32_t k = 0; k < columns; ++k) numbers.push_back(static_cast<T>(values[k]));
  }
  return array_of(name, numbers, columns);
}

/// Returns texts as rows of equal length, each with a 0 at its end.
GsdArray text_array(Name name, const std::vector<std::string>& texts) {
  std::size_t longest = 0;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  std::string bytes;
  for (const std::string& text : texts) bytes += text + std::string(longest + 1 - text.size(), '\0');
  return {name, GsdType::int8, texts.size(), static_cast<std::uint32_t>(longest + 1), std::move(bytes)};
}

/// Position in the schema's form, -L/2 <= x < L/2 as a 32-bit number, and the image it is in.
struct Wrapped {
  std::array<float, 3> position;
  std::array<std::int32_t, 3> image;
};

Wrapped wrapped(const FrameBody& body, const Vector3d& box) {
  Wrapped result{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const auto half = static_cast<float>(box[i]) / 2;
    double images = std::round((body.unwrapped[i] - body.position[i]) / box[i]);
    auto x = static_cast<float>(body.position[i]);
    if (x >= half) {  // by rounding, or on the face itself
      x = -half;
      ++images;
    }
    result.position[k] = std::max(x, -half);
    result.image[k] = static_cast<std::int32_t>(images);
  }
  return result;
}

/// Returns HOOMD's form: 2 q (0, L), L along the body's axes.
std::array<double, 4> angular_momentum(const FrameBody& body) {
  const Vector3d L = body.inertia.cwiseProduct(body.rotation.transpose() * body.angular_velocity);
  const Quaterniond q = Quaterniond(body.rotation).normalized() * Quaterniond(0, L.x(), L.y(), L.z());
  return {2 * q.w(), 2 * q.x(), 2 * q.y(), 2 * q.z()};
}

GsdArray species_array(const ed::System& system) {
  std::vector<ShapeNumbers> shapes;
  std::size_t most_vertices = 0;
  for (const ed::Species& s : system.species) {
    shapes.push_back(numbers_of(s.shape));
    most_vertices = std::max(most_vertices, shapes.back().vertices.size());
  }
  std::vector<double> rows;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const ed::Species& s = system.species[k];
    const auto& [kind, a, e, rounding, vertices] = shapes[k];
    const bool axes = has_semi_axes(kind);
    rows.insert(rows.end(), {static_cast<double>(kind), a.x(), a.y(), a.z(), axes ? e.x() : rounding,
                             axes ? e.y() : static_cast<double>(vertices.size()), s.mass, s.inertia.x(), s.inertia.y(),
                             s.inertia.z(), s.spins ? 1.0 : 0.0});
    for (const Vector3d& x : vertices) rows.insert(rows.end(), {x.x(), x.y(), x.z()});
    rows.insert(rows.end(), 3 * (most_vertices - vertices.size()), 0.0);
  }
  return array_of(kExactSpecies, rows, kSpeciesColumns + 3 * static_cast<std::uint32_t>(most_vertices));
}

std::vector<GsdArray> constant_arrays(const Frame& frame) {
  const auto edge = [&](int k) { return static_cast<float>(frame.box[k]); };
  std::vector<std::string> names;
  std::vector<std::string> shapes;
  for (const FrameType& type : frame.types) {
    names.push_back(type.name);
    shapes.push_back(type_shape_json(type.shape, frame.types.size()));
  }
  const auto one = [](auto x) { return std::array{x}; };
  return {
      {kDimensions, GsdType::uint8, 1, 1, std::string(1, '\3')},
      array_of(kBox, std::vector<float>{edge(0), edge(1), edge(2), 0, 0, 0}),
      array_of(kNumber, std::vector{static_cast<std::uint32_t>(frame.bodies.size())}),
      text_array(kTypes, names),
      text_array(kTypeShapes, shapes),
      body_array<std::uint32_t>(kTypeId, frame, 1, [&](const FrameBody& b) { return one(b.type); }),
      body_array<float>(kMass, frame, 1, [&](const FrameBody& b) { return one(b.mass); }),
      body_array<float>(kInertia, frame, 3, [](const FrameBody& b) { return b.inertia; }),
      array_of(kExactBox, std::vector{frame.exact->box}),
      species_array(*frame.exact),
      body_array<std::uint32_t>(kGroup, frame, 1, [&](const FrameBody& b) { return one(b.group); }),
  };
}

/// Returns an array of the doubles of the state.
template <class Get>
GsdArray exact_array(Name name, const ed::System& system, std::uint32_t columns, const Get& get) {
  Writer writer;
  for (const ed::Body& body : system.bodies) writer(get(body));
  return {name, GsdType::float64, system.bodies.size(), columns, writer.take()};
}

std::vector<GsdArray> moving_arrays(const Frame& frame) {
  const ed::System& system = *frame.exact;
  return {
      array_of(kStep, std::vector{frame.step}),
      body_array<float>(kPosition, frame, 3, [&](const FrameBody& b) { return wrapped(b, frame.box).position; }),
      body_array<float>(kOrientation, frame, 4, [](const FrameBody& b) { return quaternion_of(b.rotation); }),
      body_array<float>(kVelocity, frame, 3, [](const FrameBody& b) { return b.velocity; }),
      body_array<float>(kAngularMomentum, frame, 4, angular_momentum),
      body_array<std::int32_t>(kImage, frame, 3, [&](const FrameBody& b) { return wrapped(b, frame.box).image; }),
      array_of(kEnergy, std::vector{frame.energy}),
      array_of(kZ, std::vector{frame.Z}),
      array_of(kS, std::vector{frame.S}),
      exact_array(kExactPosition, system, 3, [](const ed::Body& b) { return b.position; }),
      exact_array(kExactRotation, system, 9, [](const ed::Body& b) -> Matrix3d { return b.rotation.transpose(); }),
      exact_array(kExactVelocity, system, 3, [](const ed::Body& b) { return b.velocity; }),
      exact_array(kExactAngularVelocity, system, 3, [](const ed::Body& b) { return b.angular_velocity; }),
      array_of(kTime, std::vector{frame.time}),
  };
}

GsdHead head_for(std::uint64_t capacity) {
  GsdHead head;
  head.application = fmt::format("hardbody {}", version());
  head.schema = "hoomd";
  head.schema_version = kSchemaVersion;
  head.names.assign(kNameTexts.begin(), kNameTexts.end());
  head.entries = kStep + capacity * (kNames - kStep);
  return head;
}

/// Returns the number of index entries of this number of frames.
std::uint64_t entries_of(std::uint64_t frames) {
  return frames == 0 ? 0 : kStep + frames * (kNames - kStep);
}

}  // namespace

void GsdWriter::open(FileMark mark) {
  mark_ = mark;
  if (mark.frames == 0) return;
  // The entries first: they must not point to data that no longer exists.
  const std::uint64_t from = entries_of(mark.frames);
  overwrite_at(path_, GsdHead::entry_location(from),
               std::string(GsdHead::entry_location(entries_of(capacity_)) - GsdHead::entry_location(from), '\0'));
  write_at(path_, mark.bytes, "");
}

void GsdWriter::append(const Frame& frame) {
  const bool first = mark_.frames == 0;
  const GsdHead head = head_for(capacity_);
  std::vector<GsdArray> arrays = first ? constant_arrays(frame) : std::vector<GsdArray>();
  for (GsdArray& array : moving_arrays(frame)) arrays.push_back(std::move(array));
  const std::uint64_t location = first ? head.size() : mark_.bytes;
  const GsdFrameBytes bytes = gsd_frame_bytes(mark_.frames, arrays, location);
  if (first) {
    write_file(path_, head.bytes() + bytes.data);  // renamed, so that readers never see an incomplete head
  } else {
    write_at(path_, mark_.bytes, bytes.data, Flush::later);
  }
  overwrite_at(path_, GsdHead::entry_location(entries_of(mark_.frames)), bytes.index, Flush::later);
  mark_.bytes = location + bytes.data.size();
  ++mark_.frames;
}

}  // namespace hardbody
