#include "checkpoint.h"

#include "errors.h"
#include "text_file.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace hardbody {
namespace {

constexpr std::string_view kMagic = "HARDBODY";
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr std::uint32_t kFormat = 1;
constexpr std::size_t kHead = 8 + 4 + 4 + 8;  ///< magic, byte order, format, length of the payload
constexpr std::size_t kTail = 8;              ///< checksum
constexpr std::size_t kBodyBytes = 18 * sizeof(double);
constexpr std::size_t kLongest = std::size_t{1} << 31;

// ---- Writing

template <class T>
void put(std::string& bytes, const T& value) {
  static_assert(std::is_arithmetic_v<T>);
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

void put_text(std::string& bytes, std::string_view text) {
  put(bytes, static_cast<std::uint64_t>(text.size()));
  bytes.append(text);
}

void put_vector(std::string& bytes, const Eigen::Vector3d& v) {
  for (int k = 0; k < 3; ++k) put(bytes, v[k]);
}

void put_system(std::string& bytes, const ed::System& system) {
  put(bytes, system.box);
  put_vector(bytes, system.species.shape.semi_axes());
  put(bytes, system.species.mass);
  put_vector(bytes, system.species.inertia);
  put(bytes, static_cast<std::uint8_t>(system.species.spins ? 1 : 0));
  put(bytes, static_cast<std::uint64_t>(system.bodies.size()));
  for (const ed::Body& body : system.bodies) {
    put_vector(bytes, body.position);
    for (int k = 0; k < 3; ++k) put_vector(bytes, body.rotation.col(k));
    put_vector(bytes, body.velocity);
    put_vector(bytes, body.angular_velocity);
  }
}

// ---- Reading

/// Takes values off the front of the payload.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  std::string_view take(std::uint64_t length) {
    if (length > bytes_.size()) throw damaged();
    const std::string_view taken = bytes_.substr(0, length);
    bytes_.remove_prefix(length);
    return taken;
  }

  template <class T>
  T value() {
    T result;
    std::memcpy(&result, take(sizeof(T)).data(), sizeof(T));
    return result;
  }

  std::string text() { return std::string(take(value<std::uint64_t>())); }

  Eigen::Vector3d vector() {
    const auto x = value<double>();
    const auto y = value<double>();
    const auto z = value<double>();
    return {x, y, z};
  }

  std::size_t left() const { return bytes_.size(); }

  InputError damaged() const {
    return InputError(fmt::format("{}: holds an impossible state; accepted: an undamaged checkpoint", name_));
  }

 private:
  std::string_view bytes_;
  std::string name_;
};

ed::System take_system(Reader& reader) {
  ed::System system;
  system.box = reader.value<double>();
  try {
    system.species.shape = geom::Ellipsoid(reader.vector());
  } catch (const std::invalid_argument&) {
    throw reader.damaged();
  }
  system.species.mass = reader.value<double>();
  system.species.inertia = reader.vector();
  system.species.spins = reader.value<std::uint8_t>() != 0;
  const auto number = reader.value<std::uint64_t>();
  const bool sound = system.box > 0 && std::isfinite(system.box) && system.species.shape.symmetry_axis() &&
                     number > 0 && number == reader.left() / kBodyBytes && reader.left() % kBodyBytes == 0;
  if (!sound) throw reader.damaged();
  system.bodies.resize(number);
  for (ed::Body& body : system.bodies) {
    body.position = reader.vector();
    for (int k = 0; k < 3; ++k) body.rotation.col(k) = reader.vector();
    body.velocity = reader.vector();
    body.angular_velocity = reader.vector();
  }
  return system;
}

/// The payload of a file whose head and checksum are right.
std::string_view checked_payload(std::string_view bytes, const std::string& name) {
  const auto refuse = [&](const std::string& why) {
    return InputError(fmt::format("{}: {}; accepted: an undamaged checkpoint", name, why));
  };
  if (!bytes.starts_with(kMagic)) throw refuse("is not a hardbody checkpoint");
  const std::string cut = fmt::format("is cut off after {} bytes", bytes.size());
  if (bytes.size() < kHead + kTail) throw refuse(cut);
  Reader head(bytes.substr(kMagic.size(), kHead - kMagic.size()), name);
  if (head.value<std::uint32_t>() != kByteOrder) throw refuse("was written with another byte order, or is damaged");
  const auto format = head.value<std::uint32_t>();
  const auto length = head.value<std::uint64_t>();
  if (format != kFormat) {
    throw refuse(fmt::format("has format version {}, this program reads version {}", format, kFormat));
  }
  if (length > bytes.size() - kHead - kTail) throw refuse(cut);
  if (length < bytes.size() - kHead - kTail) throw refuse("is longer than it says, so it is damaged");
  Reader tail(bytes.substr(kHead + length), name);
  if (tail.value<std::uint64_t>() != XXH3_64bits(bytes.data(), kHead + length)) {
    throw refuse("is damaged: its checksum does not fit");
  }
  return bytes.substr(kHead, length);
}

}  // namespace

std::string encode_checkpoint(const Checkpoint& checkpoint) {
  std::string payload;
  for (const std::string* text :
       {&checkpoint.program_version, &checkpoint.config, &checkpoint.cpu_features, &checkpoint.phase}) {
    put_text(payload, *text);
  }
  put(payload, checkpoint.time);
  put_system(payload, checkpoint.system);
  std::string bytes(kMagic);
  put(bytes, kByteOrder);
  put(bytes, kFormat);
  put(bytes, static_cast<std::uint64_t>(payload.size()));
  bytes += payload;
  put(bytes, static_cast<std::uint64_t>(XXH3_64bits(bytes.data(), bytes.size())));
  return bytes;
}

Checkpoint decode_checkpoint(std::string_view bytes, const std::string& name) {
  Reader reader(checked_payload(bytes, name), name);
  Checkpoint checkpoint;
  checkpoint.program_version = reader.text();
  checkpoint.config = reader.text();
  checkpoint.cpu_features = reader.text();
  checkpoint.phase = reader.text();
  checkpoint.time = reader.value<double>();
  checkpoint.system = take_system(reader);
  return checkpoint;
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
  return decode_checkpoint(read_file(path, kLongest), path.string());
}

}  // namespace hardbody
