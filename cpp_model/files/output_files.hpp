// Writing of files that a user names. A regular file is written beside its place and renamed, so it is never
// half-written; a symbolic link is followed, not replaced; a device or FIFO is written through.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace raypool {

/// Several files, all of them or none: publish() gives them their names; without it the destructor removes what has
/// been written, and earlier files stay as they are. Throws InputError with the system's reason.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Where to write the file that publish() names `path`: beside it, with its ending. A device or FIFO is its own
  /// place, or, with `whole`, for writers that go back and forth in a file, refused.
  std::filesystem::path begin(const std::filesystem::path& path, bool whole = false);
  /// A whole file at once. A device or FIFO gets it when publish() is called.
  void write(const std::filesystem::path& path, const std::string& content);
  void publish();

 private:
  struct Part {
    std::filesystem::path temporary, final;
  };
  struct Stream {
    std::filesystem::path path;
    std::string content;
  };
  std::vector<Part> parts_;
  std::vector<Stream> streams_;
};

/// One file.
void write_file(const std::filesystem::path& path, const std::string& content);

/// Makes a folder into which files will be written, and those above it.
void make_folder(const std::filesystem::path& folder);

}  // namespace raypool
