// Where the program leaves what it makes: in a checkout, or installed (config/data_folder.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace raypool {

/// Verilated units: beside the program in a build folder; of an installed program in the user's cache, a folder a
/// version. Throws InputError when there is neither XDG_CACHE_HOME nor HOME.
std::filesystem::path units_folder();

/// What is made of scenes once (scene/scene_cache.hpp): beside the program in a build folder; of an installed program
/// in the user's cache. Empty when there is neither XDG_CACHE_HOME nor HOME.
std::filesystem::path scenes_folder();

/// Results that no option sends elsewhere: out/ beside the program in a build folder; of an installed program
/// raypool-out/ in the working directory.
std::filesystem::path results_folder();

/// FNV-1a of a text, to which `seed` is that of the text before it: for names of folders that
/// must differ when their content does.
uint32_t hash_of(const std::string& text, uint32_t seed = 2166136261u);

}  // namespace raypool
