#include "cli/folders.hpp"

#include <cstdlib>
#include <string>

#include "cli/commit.hpp"
#include "cli/version.hpp"
#include "config/data_folder.hpp"
#include "isa/input_error.hpp"

namespace raypool {

namespace fs = std::filesystem;

namespace {

fs::path program_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

/// As the XDG base directory specification has it: a path that is not absolute counts as none.
/// Empty: neither that nor HOME is set.
fs::path cache_folder() {
  const char* const cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache == '/') return fs::path(cache) / "raypool";
  const char* const home = std::getenv("HOME");
  if (home != nullptr && *home == '/') return fs::path(home) / ".cache/raypool";
  return {};
}

}  // namespace

fs::path units_folder() {
  if (!installed()) return program_folder() / "units";
  // Units of another commit are made from other Verilog.
  const std::string version = *kCommit == '\0' ? std::string(kVersion) : std::string(kVersion) + "-" + kCommit;
  const fs::path cache = cache_folder();
  if (cache.empty())
    throw InputError("there is no place for Verilated units: set XDG_CACHE_HOME to a folder of your own");
  return cache / version / "units";
}

fs::path scenes_folder() {
  if (!installed()) return program_folder() / "scenes";
  const fs::path cache = cache_folder();
  return cache.empty() ? cache : cache / "scenes";
}

fs::path results_folder() { return installed() ? fs::path("raypool-out") : program_folder() / "out"; }

uint32_t hash_of(const std::string& text, uint32_t seed) {
  for (const char c : text) seed = (seed ^ static_cast<uint8_t>(c)) * 16777619u;
  return seed;
}

}  // namespace raypool
