// Values and vectors as bytes and back, for files that only the program which wrote them reads.
#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace raypool {

/// Appends what is put to a text of bytes.
class BytesWriter {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const char* const begin = reinterpret_cast<const char*>(&value);
    bytes_.append(begin, sizeof value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    put(uint64_t{values.size()});
    if (!values.empty()) bytes_.append(reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size());
  }
  void put(const std::string& text) {
    put(uint64_t{text.size()});
    bytes_ += text;
  }
  void put(const std::vector<std::string>& texts) {
    put(uint64_t{texts.size()});
    for (const std::string& text : texts) put(text);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Gets them in the same order. Throws BytesMissing where there are not enough.
struct BytesMissing : std::runtime_error {
  BytesMissing() : std::runtime_error("bytes are missing") {}
};
class BytesReader {
 public:
  explicit BytesReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  void get(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::memcpy(&value, take(sizeof value, 1), sizeof value);
  }
  template <typename T>
  void get(std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto count = number();
    const char* const from = take(count, sizeof(T));
    values.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), from, count * sizeof(T));
  }
  void get(std::string& text) {
    const auto count = number();
    text.assign(take(count, 1), count);
  }
  void get(std::vector<std::string>& texts) {
    const auto count = number();
    texts.clear();
    for (uint64_t i = 0; i < count; ++i) get(texts.emplace_back());
  }
  bool empty() const { return bytes_.empty(); }

 private:
  uint64_t number() {
    uint64_t value = 0;
    get(value);
    return value;
  }
  const char* take(uint64_t count, uint64_t size) {
    if (count > bytes_.size() / size) throw BytesMissing();
    const char* const begin = bytes_.data();
    bytes_.remove_prefix(count * size);
    return begin;
  }

  std::string_view bytes_;
};

}  // namespace raypool
