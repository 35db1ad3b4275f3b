// Where the program leaves what it makes: in a checkout, or installed (config/data_folder.hpp).
#pragma once

#include <filesystem>

namespace raypool {

/// Verilated units: beside the program in a build folder; of an installed program in the user's cache, a folder a version. Throws
/// InputError when there is neither XDG_CACHE_HOME nor HOME.
std::filesystem::path units_folder();

/// Results that no option sends elsewhere: out/ beside the program in a build folder; of an installed program raypool-out/ in the
/// working directory.
std::filesystem::path results_folder();

}  // namespace raypool
