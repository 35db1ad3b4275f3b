#include "config/data_folder.hpp"

#include <filesystem>

namespace raypool {

std::string installed_data_folder() {
  namespace fs = std::filesystem;
  std::error_code missing;
  const fs::path executable = fs::read_symlink("/proc/self/exe", missing);
  const fs::path folder = executable.parent_path().parent_path() / "share" / "raypool";
  return fs::is_directory(folder / "configs", missing) ? folder.string() : "";
}

}  // namespace raypool
