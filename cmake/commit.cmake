# Writes OUTPUT, a header with the commit that SOURCE is a checkout of ("" without git),
# and leaves it alone when it is right.
cmake_minimum_required(VERSION 3.25)
find_program(GIT git)
set(commit "")
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --tags --always --dirty OUTPUT_VARIABLE commit
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT "// The commit that this was built from; empty: unknown.
#pragma once

namespace raypool {
inline constexpr const char* kCommit = \"${commit}\";
}  // namespace raypool
")
