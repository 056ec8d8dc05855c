#pragma once

/// Values as bytes and back, bit for bit: what exact restarts are made of.
///
/// A class names its members once, for both directions, in one of
///
///     template <class Archive, class Self> static void fields(Archive& archive, Self& self);  // in the class
///     template <class Archive, Is<Type> T> void fields(Archive& archive, T& value);           // beside T
///
/// by archive(self.a_, self.b_): a Writer takes them, a Reader sets them. Numbers and enumerators are their own bytes,
/// little-endian; containers are preceded by their length in 8 bytes; nothing is padded. What bytes cannot be is looked
/// for where members are named, by `expect`: a Reader never trusts a length, and a class never an index.

#include <Eigen/Core>

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
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

/// T is U or const U.
template <class T, class U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

template <class T>
concept Scalar = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <class T>
concept FixedMatrix = requires {
  T::SizeAtCompileTime;
}
&&(T::SizeAtCompileTime > 0);

template <class T>
concept Sequence = requires(T& x) {
  x.clear();
  x.emplace_back();
  x.size();
};

/// What a value is read into.
template <class T>
struct Blank {
  static T make() { return T{}; }
};

/// Takes bytes piece by piece.
using Sink = std::function<void(std::string_view)>;

/// Appends values to bytes, which it keeps, or hands on to a sink: large states need no room of their own then.
class Writer {
 public:
  static constexpr bool kReads = false;

  Writer() = default;
  /// flush() hands on the last piece.
  explicit Writer(Sink sink) : sink_(std::move(sink)) {}

  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }

  /// Bytes as they are.
  void raw(std::string_view bytes) { raw(bytes.data(), bytes.size()); }

  void flush() {
    sink_(bytes_);
    bytes_.clear();
  }

  /// Without a sink: all of it.
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

/// Takes values off the front of bytes, which must outlive it. Throws std::invalid_argument where they end too early or
/// cannot be what they should be.
class Reader {
 public:
  static constexpr bool kReads = true;

  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }

  /// The next value.
  template <class T>
  T value() {
    T result = Blank<T>::make();
    get(result);
    return result;
  }

  /// The next `size` bytes.
  std::string_view raw(std::uint64_t size) {
    if (size > bytes_.size()) throw std::invalid_argument("state: is cut off");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

  /// Bytes that are left.
  std::size_t left() const { return bytes_.size(); }

  /// Nothing may follow.
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
      // One by one, so that memory is only taken for what is there.
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
    if (index >= sizeof...(T)) throw std::invalid_argument("state: an alternative that there is not");
    choose(value, index, std::index_sequence_for<T...>());
  }
  template <class... T, std::size_t... I>
  void choose(std::variant<T...>& value, std::size_t index, std::index_sequence<I...> /*all*/) {
    ((index == I ? get(value.template emplace<I>(Blank<T>::make())) : void()), ...);
  }

  std::string_view bytes_;
};

/// What read members must fulfil; of members that are written it is known.
template <class Archive>
void expect(const Archive& /*archive*/, bool holds, const char* what) {
  if constexpr (Archive::kReads) {
    if (!holds) throw std::invalid_argument(std::string("state: ") + what);
  }
}

/// Takes the version of a format, which must be this one.
inline void check_format(Reader& reader, std::uint32_t known) {
  const auto format = reader.value<std::uint32_t>();
  if (format == known) return;
  throw std::invalid_argument("state: has format " + std::to_string(format) + ", known is " + std::to_string(known));
}

/// A value by itself, as bytes.
template <class T>
std::string bytes_of(const T& value) {
  Writer writer;
  writer(value);
  return writer.take();
}

}  // namespace ed::archive
