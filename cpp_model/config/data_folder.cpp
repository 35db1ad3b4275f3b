#include "config/data_folder.hpp"

#include <filesystem>

namespace raypool {

namespace fs = std::filesystem;

namespace {

fs::path beside_program() {
  std::error_code missing;
  return fs::read_symlink("/proc/self/exe", missing).parent_path().parent_path() / "share" / "raypool";
}

}  // namespace

bool installed() {
  std::error_code missing;
  return fs::is_directory(beside_program() / "configs", missing);
}

std::string data_folder() { return installed() ? beside_program().string() : RAYPOOL_SOURCE; }

}  // namespace raypool
