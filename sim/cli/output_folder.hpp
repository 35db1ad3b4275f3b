// Files that a run leaves: all of them or none, and never a half-written one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace raypool {

/// A folder into which files are written under temporary names. publish() gives all of them their names, replacing what earlier
/// runs left; without it the destructor removes them, so a failed run changes nothing. Throws InputError when the folder cannot
/// be written.
class OutputFolder {
 public:
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Path to write the file `name` to before publish().
  std::filesystem::path temporary(const std::string& name);
  void write(const std::string& name, const std::string& content);
  /// Final path of a file.
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  void publish();

 private:
  std::filesystem::path temporary_path(const std::string& name) const;

  std::filesystem::path folder_;
  std::vector<std::string> names_;
};

}  // namespace raypool
