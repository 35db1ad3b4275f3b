#include "cli/output_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <system_error>

#include "config/configuration.hpp"

namespace raypool {

OutputFolder::OutputFolder(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error || !std::filesystem::is_directory(folder_) || access(folder_.c_str(), W_OK | X_OK) != 0) {
    throw InputError(fmt::format("cannot write into folder '{}'{}: name another one", folder_.string(),
                                 error ? " (" + error.message() + ")" : std::string()));
  }
}

OutputFolder::~OutputFolder() {
  for (const std::string& name : names_) {
    std::error_code ignored;
    std::filesystem::remove(temporary_path(name), ignored);
  }
}

// The process number keeps two runs into one folder apart; the ending stays, since writers of pictures and waveforms look at it.
std::filesystem::path OutputFolder::temporary_path(const std::string& name) const {
  return folder_ / fmt::format(".{}.{}", getpid(), name);
}

std::filesystem::path OutputFolder::temporary(const std::string& name) {
  names_.push_back(name);
  return temporary_path(name);
}

void OutputFolder::write(const std::string& name, const std::string& content) {
  const std::filesystem::path path = temporary(name);
  std::ofstream file(path, std::ios::binary);
  file << content;
  file.close();
  if (!file) throw InputError(fmt::format("cannot write '{}': is the disk full?", path.string()));
}

void OutputFolder::publish() {
  for (const std::string& name : names_) {
    std::error_code error;
    std::filesystem::rename(temporary_path(name), path(name), error);
    if (error)
      throw InputError(fmt::format("cannot write '{}' ({}): remove what is in its place", path(name).string(), error.message()));
  }
  names_.clear();
}

}  // namespace raypool
