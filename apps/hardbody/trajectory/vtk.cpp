#include "trajectory/vtk.h"

#include "io/text_file.h"

#include <ed/archive.h>

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <string>
#include <string_view>

namespace hardbody {
namespace {

using ed::archive::Writer;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Characters for a frame's time: 17 digits, sign, point, exponent, a blank.
constexpr std::uint64_t kTimeWidth = 25;

constexpr std::string_view kBeforeTimes =
    "<?xml version=\"1.0\"?>\n"
    "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
    "<PolyData TimeValues=\"";
constexpr std::string_view kEnd = "\n</AppendedData>\n</VTKFile>\n";

/// Array of every frame, in the order of their bytes. Every frame has all of them, also those that do not change: VTK's
/// reader loses arrays without a time step when the step is changed.
struct Array {
  const char* name;
  const char* type;
  std::uint64_t components;
};
constexpr std::array<Array, 6> kArrays = {{
    {"shape", "Float32", 9},
    {"semi_axes", "Float32", 3},
    {"orientation", "Float32", 4},
    {"velocity", "Float32", 3},
    {"species", "Int32", 1},
    {"position", "Float32", 3},
}};
constexpr std::uint64_t kNumberBytes = 4;
constexpr std::uint64_t kLengthBytes = 8;  ///< bytes of an array's length, which precedes it

std::uint64_t array_bytes(const Array& array, std::uint64_t bodies) {
  return kLengthBytes + kNumberBytes * array.components * bodies;
}

/// Writes the elements of array k, one for each frame.
void put_elements(fmt::memory_buffer& text, std::size_t k, std::uint64_t bodies, std::uint64_t capacity) {
  std::uint64_t before = 0;
  std::uint64_t frame = 0;
  for (std::size_t j = 0; j < kArrays.size(); ++j) {
    if (j < k) before += array_bytes(kArrays[j], bodies);
    frame += array_bytes(kArrays[j], bodies);
  }
  for (std::uint64_t step = 0; step < capacity; ++step) {
    fmt::format_to(std::back_inserter(text),
                   "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" TimeStep=\"{}\" format=\"appended\" "
                   "offset=\"{}\"/>\n",
                   kArrays[k].type, kArrays[k].name, kArrays[k].components, step, step * frame + before);
  }
}

/// Returns everything up to the first array's bytes, without times.
std::string head_text(std::uint64_t bodies, std::uint64_t capacity) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "{}{:{}}\">\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                 "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n"
                 "<PointData Tensors=\"shape\" Vectors=\"velocity\" Scalars=\"species\">\n",
                 kBeforeTimes, "", capacity * kTimeWidth, bodies);
  for (std::size_t k = 0; k + 1 < kArrays.size(); ++k) put_elements(text, k, bodies, capacity);
  fmt::format_to(out, "</PointData>\n<Points>\n");
  put_elements(text, kArrays.size() - 1, bodies, capacity);
  fmt::format_to(out, "</Points>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
  return fmt::to_string(text);
}

Vector3d semi_axes(const Frame& frame, const FrameBody& body) {
  const FrameType& type = frame.types[body.type];
  return type.shape ? ed::half_extents(*type.shape) : Vector3d::Zero();
}

/// Returns the tensor that transforms a unit sphere into the ellipsoid: symmetric, so that it is the same whether
/// eigenvectors or columns are taken for the axes.
Matrix3d shape_tensor(const Frame& frame, const FrameBody& body) {
  return body.rotation * semi_axes(frame, body).asDiagonal() * body.rotation.transpose();
}

/// Writes an array with its length before it.
template <class Get>
void put_array(Writer& writer, const Frame& frame, const Array& array, const Get& get) {
  writer(std::uint64_t{array_bytes(array, frame.bodies.size()) - kLengthBytes});
  for (const FrameBody& body : frame.bodies) writer(get(body));
}

std::string frame_bytes(const Frame& frame) {
  using Eigen::Vector3f;
  Writer writer;
  put_array(writer, frame, kArrays[0],
            [&](const FrameBody& b) -> Eigen::Matrix3f { return shape_tensor(frame, b).cast<float>(); });
  put_array(writer, frame, kArrays[1],
            [&](const FrameBody& b) -> Vector3f { return semi_axes(frame, b).cast<float>(); });
  put_array(writer, frame, kArrays[2],
            [](const FrameBody& b) -> Eigen::Vector4f { return quaternion_of(b.rotation).cast<float>(); });
  put_array(writer, frame, kArrays[3], [](const FrameBody& b) -> Vector3f { return b.velocity.cast<float>(); });
  put_array(writer, frame, kArrays[4], [](const FrameBody& b) { return static_cast<std::int32_t>(b.group); });
  put_array(writer, frame, kArrays[5], [](const FrameBody& b) -> Vector3f { return b.position.cast<float>(); });
  return writer.take();
}

std::uint64_t time_place(std::uint64_t frame) {
  return kBeforeTimes.size() + frame * kTimeWidth;
}

}  // namespace

void VtkWriter::open(FileMark mark) {
  mark_ = mark;
  if (mark.frames == 0) return;
  overwrite_at(path_, time_place(mark.frames), std::string((capacity_ - mark.frames) * kTimeWidth, ' '));
  write_at(path_, mark.bytes, kEnd);
}

void VtkWriter::append(const Frame& frame) {
  const bool first = mark_.frames == 0;
  const std::string head = first ? head_text(frame.bodies.size(), capacity_) : "";
  const std::string bytes = frame_bytes(frame);
  if (first) {
    write_file(path_, head + bytes + std::string(kEnd));  // renamed, so that readers never see an incomplete head
  } else {
    write_at(path_, mark_.bytes, bytes + std::string(kEnd), Flush::later);
  }
  const std::string time = fmt::format("{:.17g}", frame.time);
  overwrite_at(path_, time_place(mark_.frames), fmt::format("{:{}}", time, kTimeWidth), Flush::later);
  mark_.bytes += head.size() + bytes.size();
  ++mark_.frames;
}

}  // namespace hardbody
