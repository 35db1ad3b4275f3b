#include "config/data_folder.hpp"

#include <filesystem>
#include <fstream>
#include <ios>
#include <string>

namespace raypool {

namespace fs = std::filesystem;

namespace {

fs::path program_folder() {
  std::error_code missing;
  return fs::read_symlink("/proc/self/exe", missing).parent_path();
}

fs::path beside_program() { return program_folder().parent_path() / "share" / "raypool"; }

/// The checkout around the build folder that the program stands in: of a copy the copy, of one that was renamed, too.
/// Of a build folder elsewhere the one that this was compiled in.
fs::path checkout() {
  const std::string place = RAYPOOL_BUILD_PLACE;  // of the build folder in its checkout, "/build"; empty: elsewhere
  for (fs::path folder = program_folder(); !place.empty() && folder.has_relative_path();
       folder = folder.parent_path()) {
    const std::string text = folder.string();
    if (text.size() <= place.size() || text.compare(text.size() - place.size(), place.size(), place) != 0) continue;
    fs::path above = text.substr(0, text.size() - place.size());
    std::error_code missing;
    if (fs::is_directory(above / "configs", missing)) return above;
  }
  return RAYPOOL_SOURCE;
}

}  // namespace

bool installed() {
  std::error_code missing;
  return fs::is_directory(beside_program() / "configs", missing);
}

std::string data_folder() { return installed() ? beside_program().string() : checkout().string(); }

std::string program_command() {
  std::ifstream words("/proc/self/cmdline", std::ios::binary);
  std::string first;
  std::getline(words, first, '\0');
  return first.empty() ? "raypool" : first;
}

}  // namespace raypool
