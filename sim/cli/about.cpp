#include "cli/about.hpp"

#include <assimp/version.h>
#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <CLI/Version.hpp>
#include <nlohmann/json.hpp>
#include <systemc>

#include "cli/commit.hpp"
#include "cli/version.hpp"

namespace raypool {

std::string about() {
  const std::string commit = *kCommit == '\0' ? "" : fmt::format(" ({})", kCommit);
  return fmt::format(
      "raypool {}{}\nSystemC {}, Embree {}, Assimp {}.{}.{}, fmt {}.{}.{}, nlohmann-json {}.{}.{}, CLI11 {}; GCC {}",
      kVersion, commit, sc_core::sc_release(), RTC_VERSION_STRING, aiGetVersionMajor(), aiGetVersionMinor(),
      aiGetVersionPatch(), FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100, NLOHMANN_JSON_VERSION_MAJOR,
      NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH, CLI11_VERSION, __VERSION__);
}

}  // namespace raypool
