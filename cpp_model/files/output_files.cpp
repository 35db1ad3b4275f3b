#include "files/output_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "isa/input_error.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // as Linux

[[noreturn]] void fail(const fs::path& path, int error) {
  throw InputError(fmt::format("cannot write '{}' ({}): nothing was changed; name another file or mend it",
                               path.string(), std::strerror(error)));
}

/// Where a path leads.
struct Place {
  bool stream = false;  ///< a device, FIFO or pipe
  fs::path file;        ///< else the file behind all links, which need not exist
  mode_t mode = 0;      ///< its permissions if it exists, else 0
};

Place find_place(const fs::path& path) {
  if (path.filename().empty()) fail(path, EISDIR);
  struct stat status {};
  Place place;
  if (stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) fail(path, EISDIR);
    // A file that may not be written may not be replaced either.
    if (access(path.c_str(), W_OK) != 0) fail(path, errno);
    place.stream = !S_ISREG(status.st_mode);
    place.mode = status.st_mode & 07777u;
  } else if (errno != ENOENT) {
    fail(path, errno);
  }
  place.file = path;
  for (int links = 0; !place.stream && fs::is_symlink(fs::symlink_status(place.file)); ++links) {
    if (links == kMostLinks) fail(path, ELOOP);
    // What stands in /proc are open files: /dev/stdout, sent to a file, is owned by the process that has opened it.
    place.stream = place.file.string().compare(0, 6, "/proc/") == 0;
    place.file = place.file.parent_path() / fs::read_symlink(place.file);
  }
  return place;
}

int open_stream(const fs::path& path) { return open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC); }

/// Writes all of it and closes the file; 0, or the system's error.
int write_and_close(int file, const std::string& content) {
  if (file < 0) return errno;
  int error = 0;
  for (size_t done = 0; error == 0 && done < content.size();) {
    const ssize_t count = write(file, content.data() + done, content.size() - done);
    if (count > 0) done += static_cast<size_t>(count);
    if (count < 0 && errno != EINTR) error = errno;
  }
  // Network file systems report a full disk only now.
  if (close(file) != 0 && error == 0) error = errno;
  return error;
}

}  // namespace

OutputFiles::~OutputFiles() {
  for (const Part& part : parts_) {
    std::error_code ignored;
    fs::remove(part.temporary, ignored);
  }
}

fs::path OutputFiles::begin(const fs::path& path, bool whole) {
  const Place place = find_place(path);
  if (place.stream && whole) {
    throw InputError(fmt::format("cannot write '{}': this needs a regular file, not a device or FIFO", path.string()));
  }
  if (place.stream) return path;
  clear(place.file);
  fs::path temporary = place.file.parent_path() / temporary_name(place.file.filename());
  parts_.push_back({temporary, place.file, RemovedWhenStopped(temporary)});
  // Made here, so that a folder that may not be written to is reported before the work.
  const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const int error = file < 0 ? errno : 0;
  if (error != 0) fail(path, error);
  if (place.mode != 0) static_cast<void>(fchmod(file, place.mode));
  close(file);
  return temporary;
}

void OutputFiles::write(const fs::path& path, const std::string& content) {
  const fs::path place = begin(path);
  if (place == path) {
    streams_.push_back({path, content});
    return;
  }
  const int error = write_and_close(open(place.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC), content);
  if (error != 0) fail(path, error);
}

void OutputFiles::publish() {
  // What cannot be taken back comes first, as it may fail; renaming within a folder hardly does.
  for (const Stream& stream : streams_) {
    const int error = write_and_close(open_stream(stream.path), stream.content);
    if (error != 0)
      throw InputError(fmt::format("cannot write to '{}' ({})", stream.path.string(), std::strerror(error)));
  }
  streams_.clear();
  for (const Part& part : parts_) {
    if (std::rename(part.temporary.c_str(), part.final.c_str()) != 0) fail(part.final, errno);
  }
  parts_.clear();
  holds_.clear();
}

void OutputFiles::clear_unfinished(const fs::path& path) {
  const Place place = find_place(path);
  if (!place.stream) clear(place.file);
}

void OutputFiles::clear(const fs::path& file) {
  const fs::path folder = file.parent_path();
  holds_.try_emplace(folder, folder).first->second.clear(file.filename());
}

void write_file(const fs::path& path, const std::string& content) {
  OutputFiles files;
  files.write(path, content);
  files.publish();
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  int reason = error ? error.value() : 0;
  if (reason == 0 && !fs::is_directory(folder)) reason = ENOTDIR;
  if (reason == 0 && access(folder.c_str(), W_OK | X_OK) != 0) reason = errno;
  if (reason != 0) {
    throw InputError(
        fmt::format("cannot write into folder '{}' ({}): name another one", folder.string(), std::strerror(reason)));
  }
}

}  // namespace raypool
