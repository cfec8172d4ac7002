#pragma once
/// Numbers as bytes, as this machine has them: what is written on one machine is for that machine to read.
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace grainvdb {

class ByteWriter {
 public:
  virtual ~ByteWriter() = default;
  virtual void write(const void* bytes, std::size_t count) = 0;

  template <class T>
  void number(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    write(&value, sizeof value);
  }
  template <class T>
  void numbers(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    number(std::uint64_t{values.size()});
    write(values.data(), values.size() * sizeof(T));
  }
  void text(const std::string& value) {
    number(std::uint64_t{value.size()});
    write(value.data(), value.size());
  }
};

/// Reads what a ByteWriter wrote, in the same order.
class ByteReader {
 public:
  virtual ~ByteReader() = default;
  virtual void read(void* bytes, std::size_t count) = 0;

  template <class T>
  T number() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    read(&value, sizeof value);
    return value;
  }
  std::size_t count() { return static_cast<std::size_t>(number<std::uint64_t>()); }
  template <class T>
  std::vector<T> numbers() {
    std::vector<T> values(count());
    read(values.data(), values.size() * sizeof(T));
    return values;
  }
  std::string text() {
    std::string value(count(), '\0');
    read(value.data(), value.size());
    return value;
  }
};

}  // namespace grainvdb
