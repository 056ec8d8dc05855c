#pragma once

/// @file
/// Serialisation of values to bytes and back, bit for bit, for exact restarts.
///
/// A class names its members once, for both directions, in one of
///
///     template <class Archive, class Self> static void fields(Archive& archive, Self& self);  // in the class
///     template <class Archive, Is<Type> T> void fields(Archive& archive, T& value);           // beside T
///
/// by archive(self.a_, self.b_): a Writer takes them, a Reader sets them. Numbers and enumerators are stored as in
/// memory, little-endian; containers are preceded by their length in 8 bytes; there is no padding. Invalid values are
/// rejected where members are named, by `expect`: a Reader never trusts a length, and a class never an index.

#include <ed/sink.h>

#include <geom/kernel/eigen_layout.h>

#include <Eigen/Core>

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace ed::archive {

static_assert(std::endian::native == std::endian::little, "states are written as they are in memory");

/// True if T is U or const U.
template <class T, class U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

/// Type that is stored as its own bytes.
template <class T>
concept Scalar = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Eigen matrix of fixed size.
template <class T>
concept FixedMatrix = requires {
  T::SizeAtCompileTime;
}
&&(T::SizeAtCompileTime > 0);

/// Container that elements are appended to.
template <class T>
concept Sequence = requires(T& x) {
  x.clear();
  x.emplace_back();
  x.size();
};

/// Makes the object that a value is read into.
template <class T>
struct Blank {
  static T make() { return T{}; }  ///< makes the object
};

/// Appends values to a buffer of bytes. With a sink the buffer is handed on piece by piece, so that large states need
/// no memory of their own.
class Writer {
 public:
  static constexpr bool kReads = false;  ///< direction of this archive

  Writer() = default;
  /// Constructs a writer that hands its bytes to `sink`; flush() hands on the last piece.
  explicit Writer(Sink sink) : sink_(std::move(sink)) {}

  /// Appends values.
  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }

  /// Appends bytes unchanged.
  void raw(std::string_view bytes) { raw(bytes.data(), bytes.size()); }

  /// Hands all bytes to the sink.
  void flush() {
    sink_(bytes_);
    bytes_.clear();
  }

  /// Returns all bytes written; only for a writer without a sink.
  std::string take() { return std::move(bytes_); }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 20;

  void raw(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
    if (sink_ && bytes_.size() >= kPiece) flush();
  }

  template <class T>
  void put(const T& value) {
    if constexpr (Scalar<T>) {
      raw(&value, sizeof value);
    } else if constexpr (FixedMatrix<T>) {
      raw(value.data(), sizeof(typename T::Scalar) * T::SizeAtCompileTime);
    } else if constexpr (std::same_as<T, std::string>) {
      put(std::uint64_t{value.size()});
      raw(value.data(), value.size());
    } else if constexpr (Sequence<T>) {
      put(std::uint64_t{value.size()});
      for (const auto& element : value) put(element);
    } else if constexpr (requires { T::fields(*this, value); }) {
      T::fields(*this, value);
    } else {
      fields(*this, value);
    }
  }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class... T>
  void put(const std::variant<T...>& value) {
    put(static_cast<std::uint8_t>(value.index()));
    std::visit([this](const auto& alternative) { this->put(alternative); }, value);
  }

  std::string bytes_;
  Sink sink_;
};

/// Takes values off the front of bytes, which must outlive it. Throws std::invalid_argument if they end too early or
/// have an invalid value.
class Reader {
 public:
  static constexpr bool kReads = true;  ///< direction of this archive

  /// Constructs a reader of these bytes.
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  /// Reads values in the order in which they were written.
  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }

  /// Reads the next value.
  template <class T>
  T value() {
    T result = Blank<T>::make();
    get(result);
    return result;
  }

  /// Returns the next `size` bytes.
  std::string_view raw(std::uint64_t size) {
    if (size > bytes_.size()) throw std::invalid_argument("state: is cut off");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

  /// Returns the number of bytes left.
  std::size_t left() const { return bytes_.size(); }

  /// Throws std::invalid_argument if bytes are left.
  void finish() const {
    if (!bytes_.empty()) throw std::invalid_argument("state: is longer than it should be");
  }

 private:
  void copy(void* data, std::size_t size) { std::memcpy(data, raw(size).data(), size); }

  template <class T>
  void get(T& value) {
    if constexpr (std::same_as<T, bool>) {
      const auto byte = this->value<std::uint8_t>();
      if (byte > 1) throw std::invalid_argument("state: a truth value is neither true nor false");
      value = byte == 1;
    } else if constexpr (Scalar<T>) {
      copy(&value, sizeof value);
    } else if constexpr (FixedMatrix<T>) {
      copy(value.data(), sizeof(typename T::Scalar) * T::SizeAtCompileTime);
    } else if constexpr (std::same_as<T, std::string>) {
      value = raw(this->value<std::uint64_t>());
    } else if constexpr (Sequence<T>) {
      // One by one, so that a corrupt length cannot allocate more than the bytes hold.
      value.clear();
      for (auto k = this->value<std::uint64_t>(); k > 0; --k) get(value.emplace_back());
    } else if constexpr (requires { T::fields(*this, value); }) {
      T::fields(*this, value);
    } else {
      fields(*this, value);
    }
  }
  template <class T, std::size_t N>
  void get(std::array<T, N>& values) {
    for (T& value : values) get(value);
  }
  template <class T>
  void get(std::optional<T>& value) {
    value.reset();
    if (this->value<bool>()) get(value.emplace(Blank<T>::make()));
  }
  template <class... T>
  void get(std::variant<T...>& value) {
    const auto index = this->value<std::uint8_t>();
    if (index >= sizeof...(T)) throw std::invalid_argument("state: an unknown alternative");
    choose(value, index, std::index_sequence_for<T...>());
  }
  template <class... T, std::size_t... I>
  void choose(std::variant<T...>& value, std::size_t index, std::index_sequence<I...> /*all*/) {
    ((index == I ? get(value.template emplace<I>(Blank<T>::make())) : void()), ...);
  }

  std::string_view bytes_;
};

/// Throws std::invalid_argument if a condition on read members does not hold. Does nothing when writing, where it
/// always holds.
template <class Archive>
void expect(const Archive& /*archive*/, bool holds, const char* what) {
  if constexpr (Archive::kReads) {
    if (!holds) throw std::invalid_argument(std::string("state: ") + what);
  }
}

/// Reads the version of a format and throws std::invalid_argument unless it is `known`.
inline void check_format(Reader& reader, std::uint32_t known) {
  const auto format = reader.value<std::uint32_t>();
  if (format == known) return;
  throw std::invalid_argument("state: has format " + std::to_string(format) + ", known is " + std::to_string(known));
}

/// Returns the bytes of a single value.
template <class T>
std::string bytes_of(const T& value) {
  Writer writer;
  writer(value);
  return writer.take();
}

}  // namespace ed::archive
