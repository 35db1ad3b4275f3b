#include "scene/gltf_file.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <optional>

#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

constexpr size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;  // "JSON", "BIN\0"
constexpr uint64_t kLargestBuffer = uint64_t{1} << 40;

uint32_t word_at(const std::string& bytes, size_t place) {
  uint32_t word = 0;
  for (size_t i = 4; i-- > 0;) word = word << 8 | static_cast<uint8_t>(bytes[place + i]);
  return word;
}

/// None: not base64.
std::optional<std::string> decode_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> value{};
  value.fill(-1);
  for (size_t i = 0; i < kDigits.size(); ++i) value[static_cast<uint8_t>(kDigits[i])] = static_cast<int>(i);
  for (int padding = 0; padding < 2 && !text.empty() && text.back() == '='; ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;  // a digit alone is no byte
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int digit = value[static_cast<uint8_t>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count);
  }
  return bytes;
}

std::string decode_data_uri(const std::string& uri, const JsonPlace& place) {
  const size_t comma = uri.find(',');
  const std::string_view kind = std::string_view(uri).substr(0, comma == std::string::npos ? uri.size() : comma);
  const bool base64 = comma != std::string::npos && kind.size() >= 7 && kind.substr(kind.size() - 7) == ";base64";
  const std::optional<std::string> bytes =
      base64 ? decode_base64(std::string_view(uri).substr(comma + 1)) : std::nullopt;
  if (!bytes) place.fail("is a data URI that is not base64; export the file again");
  return *bytes;
}

/// %20 and the like.
std::string percent_decoded(const std::string& uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    const std::string digits = uri[i] == '%' ? uri.substr(i + 1, 2) : "";
    if (digits.size() == 2 && digits.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos) {
      text += static_cast<char>(std::stoi(digits, nullptr, 16));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

}  // namespace

GltfFile::GltfFile(const std::string& path) : path_(path) {
  const std::string bytes = read_text_file(path, "glTF file");
  if (bytes.empty()) throw InputError(path + ": the file is empty; export it again");
  json_ = parse_json(bytes.compare(0, 4, "glTF") == 0 ? read_binary(bytes) : bytes, path);
}

/// Returns the JSON text.
std::string GltfFile::read_binary(const std::string& bytes) {
  const auto cut_off = [&](uint64_t wanted) {
    return InputError(
        fmt::format("{}: the file is cut off: it has {} bytes, and should have {}; copy or export it again", path_,
                    bytes.size(), wanted));
  };
  if (bytes.size() < kHeaderBytes + kChunkHeaderBytes) throw cut_off(kHeaderBytes + kChunkHeaderBytes);
  if (word_at(bytes, 4) != 2) {
    throw InputError(fmt::format("{}: binary glTF of version {}; export it as glTF 2.0", path_, word_at(bytes, 4)));
  }
  const uint64_t length = word_at(bytes, 8);
  if (length > bytes.size()) throw cut_off(length);
  // All of the file is there, and its header or a chunk declares another size.
  const auto contradicts = [&](uint64_t end) {
    return InputError(
        fmt::format("{}: its chunks go to byte {}, but its header declares a file of {} bytes, and it "
                    "has {}; export it again",
                    path_, end, length, bytes.size()));
  };
  if (length < kHeaderBytes + kChunkHeaderBytes) throw contradicts(kHeaderBytes + kChunkHeaderBytes);
  std::string text;
  for (uint64_t place = kHeaderBytes; place + kChunkHeaderBytes <= length;) {
    const uint64_t size = word_at(bytes, place), begin = place + kChunkHeaderBytes;
    const uint32_t type = word_at(bytes, place + 4);
    if (begin + size > bytes.size()) throw cut_off(begin + size);
    if (begin + size > length) throw contradicts(begin + size);
    if (place == kHeaderBytes) {
      if (type != kJsonChunk) throw InputError(path_ + ": its first chunk is not JSON; export it as glTF 2.0");
      text = bytes.substr(begin, size);
    } else if (type == kBinaryChunk && !has_chunk_) {
      has_chunk_ = true;
      chunk_ = bytes.substr(begin, size);
    }
    place = begin + size;
  }
  return text;
}

std::string GltfFile::read_external(const std::string& uri, const JsonPlace& place, const std::string& what) const {
  const fs::path name = percent_decoded(uri);
  bool outside = name.empty() || name.is_absolute() || uri.find("://") != std::string::npos;
  for (const fs::path& part : name) outside = outside || part == "..";
  if (outside || name.native().find('\0') != std::string::npos) {
    place.fail(fmt::format("is '{}'; it must be a file in the folder of this one, or below it", uri));
  }
  return read_file((fs::path(path_).parent_path() / name).string(), what + " of " + path_);
}

std::string GltfFile::image(const JsonPlace& place) {
  if (const std::optional<JsonPlace> uri = place.find("uri")) {
    const std::string text = uri->text();
    return text.compare(0, 5, "data:") == 0 ? decode_data_uri(text, *uri) : read_external(text, *uri, "image");
  }
  const JsonPlace view = place.at("bufferView").in(root(), "bufferViews"), number = view.at("buffer");
  const JsonPlace source = number.in(root(), "buffers");
  const std::string& bytes = buffer(source, number.whole(0, kLargestBuffer));
  const std::optional<JsonPlace> begin = view.find("byteOffset");
  const uint64_t offset = begin ? begin->whole(0, kLargestBuffer) : 0;
  const uint64_t length = view.at("byteLength").whole(1, kLargestBuffer);
  if (offset + length > bytes.size())
    view.fail(fmt::format("goes to byte {} of a buffer of {}; export the file again", offset + length, bytes.size()));
  return bytes.substr(offset, length);
}

const std::string& GltfFile::buffer(const JsonPlace& place, size_t index) {
  const auto known = buffers_.find(index);
  if (known != buffers_.end()) return known->second;
  const uint64_t length = place.at("byteLength").whole(1, kLargestBuffer);
  const std::optional<JsonPlace> uri = place.find("uri");
  std::string bytes;
  if (uri) {
    const std::string text = uri->text();
    bytes = text.compare(0, 5, "data:") == 0 ? decode_data_uri(text, *uri) : read_external(text, *uri, "buffer");
  } else if (index == 0 && has_chunk_) {
    bytes.swap(chunk_);
  } else {
    place.fail("has no uri, and there is no binary chunk for it; export the file again, with its buffers");
  }
  if (bytes.size() < length) {
    place.fail(fmt::format("has {} bytes, fewer than its byteLength of {}: it is cut off; copy or export it again",
                           bytes.size(), length));
  }
  bytes.resize(length);
  return buffers_.emplace(index, std::move(bytes)).first->second;
}

}  // namespace raypool
