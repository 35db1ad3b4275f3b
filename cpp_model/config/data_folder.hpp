// Where the files lie that belong to an installed program.
#pragma once

#include <string>

namespace raypool {

/// <prefix>/share/raypool, if the running program is <prefix>/bin/... and this folder is there; else empty, as in a build folder.
std::string installed_data_folder();

}  // namespace raypool
