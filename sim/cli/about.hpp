// `raypool --version`
#pragma once

#include <string>

namespace raypool {

/// Version, commit if known, and the libraries behind results and files; two lines without an end of line.
std::string about();

}  // namespace raypool
