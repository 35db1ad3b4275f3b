// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Writing of files that a user names. A regular file is written beside its place and renamed, so it is never
// half-written; a symbolic link is followed, not replaced; a device or FIFO is written through.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "files/unfinished.hpp"

namespace raypool {

/// Several files, all of them or none: publish() gives them their names; without it the destructor removes what has
/// been written, and earlier files stay as they are. What a run that was killed has left of a file is cleared when it
/// is begun again (FolderHold::clear). Throws InputError with the system's reason.
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
  /// Clears what runs that were killed have left of a file, without beginning it.
  void clear_unfinished(const std::filesystem::path& path);

 private:
  struct Part {
    std::filesystem::path temporary, final;
    RemovedWhenStopped guard;
  };
  struct Stream {
    std::filesystem::path path;
    std::string content;
  };
  void clear(const std::filesystem::path& file);

  std::map<std::filesystem::path, FolderHold> holds_;  // longer than the parts
  std::vector<Part> parts_;
  std::vector<Stream> streams_;
};

/// One file.
void write_file(const std::filesystem::path& path, const std::string& content);

/// Makes a folder into which files will be written, and those above it.
void make_folder(const std::filesystem::path& folder);

}  // namespace raypool
