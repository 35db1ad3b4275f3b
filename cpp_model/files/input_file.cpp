#include "files/input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "isa/input_error.hpp"

namespace raypool {

namespace {

thread_local const FilesRead::Told* watching = nullptr;

}  // namespace

FilesRead::FilesRead(Told told) : told_(std::move(told)), before_(watching) { watching = &told_; }
FilesRead::~FilesRead() { watching = before_; }
void tell_missing(const std::string& path) {
  if (watching != nullptr) (*watching)(path, nullptr);
}

std::string read_file(const std::string& path, const std::string& what) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  int error = file < 0 ? errno : 0;
  std::string text;
  struct stat status {};
  if (file >= 0 && fstat(file, &status) == 0 && S_ISREG(status.st_mode))
    text.reserve(static_cast<size_t>(status.st_size));
  std::array<char, 1 << 16> part{};
  for (ssize_t count = 1; error == 0 && count != 0;) {
    count = read(file, part.data(), part.size());
    if (count > 0) text.append(part.data(), static_cast<size_t>(count));
    // A folder can be opened; the error comes when it is read.
    if (count < 0 && errno != EINTR) error = errno;
  }
  if (file >= 0) close(file);
  if (watching != nullptr) (*watching)(path, error == 0 ? &text : nullptr);
  if (error != 0)
    throw InputError(fmt::format("{}: the {} cannot be read ({}); check the path", path, what, std::strerror(error)));
  return text;
}

namespace {

/// Of UTF-8, which needs none; editors and exporters of Windows put it there.
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

/// "UTF-16" or "UTF-32", from the byte order mark, or from the zeros of its first two characters; null: neither.
const char* wide_encoding(std::string_view text) {
  using namespace std::string_view_literals;
  const std::string_view start = text.substr(0, 4);
  if (start == "\xff\xfe\0\0"sv || start == "\0\0\xfe\xff"sv) return "UTF-32";
  if (start.substr(0, 2) == "\xff\xfe" || start.substr(0, 2) == "\xfe\xff") return "UTF-16";
  if (start.size() < 4) return nullptr;
  const bool even = start[0] == '\0' && start[2] == '\0', odd = start[1] == '\0' && start[3] == '\0';
  if (even == odd) return nullptr;
  const int zeros = static_cast<int>(std::count(start.begin(), start.end(), '\0'));
  return zeros == 3 ? "UTF-32" : zeros == 2 ? "UTF-16" : nullptr;
}

}  // namespace

std::string read_text_file(const std::string& path, const std::string& what) {
  std::string text = read_file(path, what);
  if (const char* encoding = wide_encoding(text))
    throw InputError(fmt::format("{}: the {} is {} text, which is not read; save it as UTF-8", path, what, encoding));
  size_t begin = 0;
  while (text.compare(begin, kByteOrderMark.size(), kByteOrderMark) == 0) begin += kByteOrderMark.size();
  text.erase(0, begin);
  return text;
}

void use_line_feeds(std::string& text) {
  size_t to = 0;
  for (size_t from = 0; from < text.size(); ++from, ++to) {
    if (text[from] == '\r') {
      size_t next = from;
      while (next < text.size() && text[next] == '\r') ++next;
      // Empty lines of a file without line feeds stay lines.
      if (next < text.size() && text[next] == '\n') from = next;
      text[to] = '\n';
    } else {
      text[to] = text[from];
    }
  }
  text.resize(to);
}

}  // namespace raypool
