#include "cli/text_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "config/configuration.hpp"

namespace raypool {

std::string read_text(const std::string& path) {
  std::ostringstream text;
  if (path == "-") {
    text << std::cin.rdbuf();
    return text.str();
  }
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) throw InputError(fmt::format("cannot read '{}': check the path", path));
  text << file.rdbuf();
  return text.str();
}

}  // namespace raypool
