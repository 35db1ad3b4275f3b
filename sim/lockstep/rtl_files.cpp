#include "lockstep/rtl_files.hpp"

namespace raypool::lockstep {

namespace {

/// All of rtl/, as CMake finds it.
constexpr std::string_view kFiles[] = {
#include "lockstep/rtl_files.inc"
};

std::string_view file_of(std::string_view module) {
  const std::string end = "/rp_" + std::string(module) + ".v";
  for (const std::string_view file : kFiles)
    if (file.size() > end.size() && file.substr(file.size() - end.size()) == end) return file;
  return module;
}

}  // namespace

std::string rtl_files(std::initializer_list<std::string_view> modules) {
  std::string text;
  for (const std::string_view module : modules) {
    if (!text.empty()) text += ", ";
    text += file_of(module);
  }
  return text;
}

}  // namespace raypool::lockstep
