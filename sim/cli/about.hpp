// `raypool --version`
#pragma once

#include <string>

namespace raypool {

/// Version, commit if known, and the libraries behind results and files; two lines.
std::string about();

}  // namespace raypool
