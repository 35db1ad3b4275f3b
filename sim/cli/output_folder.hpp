// The folder of the files that a run leaves: all of them or none, and never a half-written one.
#pragma once

#include <filesystem>
#include <string>

#include "files/output_files.hpp"

namespace raypool {

/// OutputFiles in one folder, which is made if it is missing. publish() replaces what earlier runs left; a failed run
/// changes nothing. Throws InputError when the folder cannot be written.
class OutputFolder {
 public:
  explicit OutputFolder(const std::filesystem::path& folder) : folder_(folder) { make_folder(folder_); }

  /// Path to write the file `name` to before publish(), by a writer of its own.
  std::filesystem::path temporary(const std::string& name) { return files_.begin(path(name), true); }
  void write(const std::string& name, const std::string& content) { files_.write(path(name), content); }
  /// Final path of a file.
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  void publish() { files_.publish(); }
  /// Clears what runs that were killed have left of the file `name`.
  void clear_unfinished(const std::string& name) { files_.clear_unfinished(path(name)); }

 private:
  std::filesystem::path folder_;
  OutputFiles files_;
};

}  // namespace raypool
