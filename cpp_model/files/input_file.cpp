#include "files/input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "isa/input_error.hpp"

namespace raypool {

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
    // A folder can be opened, and says what it is when it is read.
    if (count < 0 && errno != EINTR) error = errno;
  }
  if (file >= 0) close(file);
  if (error != 0)
    throw InputError(fmt::format("{}: the {} cannot be read ({}); check the path", path, what, std::strerror(error)));
  return text;
}

}  // namespace raypool
