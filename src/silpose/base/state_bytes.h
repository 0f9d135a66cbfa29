// to_bytes(), from_bytes(): the state of running work as bytes, for the same program to resume later. Numbers, enums,
// strings, lists, optionals, pairs, Eigen's matrices, and whatever lists its members:
//   struct State { int step = 0; std::vector<double> pose; static auto members(auto& s) { return std::tie(s.step,
//   s.pose); } }; const std::string bytes = to_bytes(state, weight);
// The bytes are this machine's own. They carry no names: a file of them needs a version (base/checked_file.h).
// Threads: functions without state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

namespace silpose {

namespace detail {

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T>
concept HasMembers = requires(T& value) {
  T::members(value);
};
template <class T>
concept Tuple = requires {
  std::tuple_size<T>::value;
};
template <class T>
concept Matrix = requires(T& value) {
  value.rows();
  value.cols();
  T::SizeAtCompileTime;
};

class StateWriter {
 public:
  template <class T>
  void put(const T& value) {
    if constexpr (Plain<T>) {
      put_block(&value, 1);
    } else if constexpr (HasMembers<T>) {
      put(T::members(value));
    } else if constexpr (Tuple<T>) {
      std::apply([&](const auto&... members) { (put(members), ...); }, value);
    } else if constexpr (Matrix<T>) {
      put(int64_t{value.rows()});
      put(int64_t{value.cols()});
      put_block(value.data(), static_cast<size_t>(value.size()));
    } else if constexpr (requires { value.has_value(); }) {
      put(value.has_value());
      if (value) put(*value);
    } else {
      put(uint64_t{value.size()});
      if constexpr (is_block<T>()) {
        put_block(value.data(), value.size());
      } else {
        for (const auto& element : value) put(element);
      }
    }
  }
  std::string take() { return std::move(bytes_); }

  template <class T>
  static constexpr bool is_block() {  // may be copied whole
    return Plain<typename T::value_type> && requires(T & list) { list.data(); };
  }

 private:
  template <class T>
  void put_block(const T* data, size_t count) {
    if (count > 0) bytes_.append(reinterpret_cast<const char*>(data), count * sizeof(T));
  }
  std::string bytes_;
};

// False once anything did not fit; then nothing more is read. Counts are checked before anything is allocated.
class StateReader {
 public:
  explicit StateReader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  bool get(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      uint8_t byte = 0;  // a bool must not even hold anything but 0 and 1
      if (!get(byte) || byte > 1) return false;
      value = byte == 1;
      return true;
    } else if constexpr (Plain<T>) {
      return get_block(&value, 1);
    } else if constexpr (HasMembers<T>) {
      return get_all(T::members(value));
    } else if constexpr (Tuple<T>) {
      return std::apply([&](auto&... members) { return (get(members) && ...); }, value);
    } else if constexpr (Matrix<T>) {
      int64_t rows = 0, cols = 0;
      if (!get(rows) || !get(cols) || rows < 0 || cols < 0) return false;
      if (T::SizeAtCompileTime >= 0 && (rows != value.rows() || cols != value.cols())) return false;
      if (rows > 0 && static_cast<uint64_t>(cols) > bytes_.size() / static_cast<uint64_t>(rows)) return false;
      if constexpr (T::SizeAtCompileTime < 0) value.resize(rows, cols);
      return get_block(value.data(), static_cast<size_t>(rows * cols));
    } else if constexpr (requires { value.has_value(); }) {
      bool is_there = false;
      if (!get(is_there)) return false;
      if (!is_there) {
        value.reset();
        return true;
      }
      typename T::value_type content{};  // not in place: GCC 14 takes what emplace() resets for uninitialised
      if (!get(content)) return false;
      value = std::move(content);
      return true;
    } else {
      uint64_t count = 0;
      if (!get(count) || count > bytes_.size()) return false;
      if constexpr (StateWriter::is_block<T>()) {
        if (count > bytes_.size() / sizeof(typename T::value_type)) return false;
        value.resize(count);
        return get_block(value.data(), count);
      } else {
        value.clear();
        value.resize(count);
        for (auto& element : value) {
          if (!get(element)) return false;
        }
        return true;
      }
    }
  }
  template <class... T>
  bool get_all(std::tuple<T&...> values) {
    return std::apply([&](auto&... each) { return (get(each) && ...); }, values);
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

 private:
  template <class T>
  bool get_block(T* data, size_t count) {
    if (count > bytes_.size() / sizeof(T)) return false;
    if (count > 0) std::memcpy(static_cast<void*>(data), bytes_.data(), count * sizeof(T));
    bytes_.remove_prefix(count * sizeof(T));
    return true;
  }
  std::string_view bytes_;
};

}  // namespace detail

template <class... T>
[[nodiscard]] std::string to_bytes(const T&... values) {
  detail::StateWriter out;
  (out.put(values), ...);
  return out.take();
}

// False where the bytes are not those of such values: too few, some left over, a count that cannot be. The values are
// then undefined.
template <class... T>
[[nodiscard]] bool from_bytes(std::string_view bytes, T&... values) {
  detail::StateReader in(bytes);
  return (in.get(values) && ...) && in.at_end();
}

}  // namespace silpose
