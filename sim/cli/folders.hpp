// Where the program finds what belongs to it and leaves what it makes: in a checkout, or installed.
#pragma once

#include <filesystem>

namespace raypool {

/// Whether the program is an installed one.
bool installed();

/// Holds configs/, rtl/, scripts/: the checkout that the program was built from, or <prefix>/share/raypool.
std::filesystem::path data_folder();

/// Verilated units: beside the program in a build folder; of an installed program in the user's cache, a folder a version. Throws
/// InputError when there is neither XDG_CACHE_HOME nor HOME.
std::filesystem::path units_folder();

/// Results that no option sends elsewhere: out/ beside the program in a build folder; of an installed program raypool-out/ in the
/// working directory.
std::filesystem::path results_folder();

}  // namespace raypool
