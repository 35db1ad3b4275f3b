// The exit codes of `raypool`, one table: main/main.cpp returns them, --help and the man page
// print them, docs/use/package.md lists them.
#pragma once

#include <array>

namespace raypool {

inline constexpr int kDone = 0;
inline constexpr int kInputFailure = 1;
inline constexpr int kDifference = 2;
inline constexpr int kOtherFailure = 3;

struct ExitCode {
  int code;
  const char* meaning;
};
inline constexpr std::array<ExitCode, 4> kExitCodes = {{
    {kDone, "done, and every check of it passed"},
    {kInputFailure, "unusable option, file or program; unwritable output; a program that faults or reaches its limit"},
    {kDifference, "the lockstep found a difference between hardware and model"},
    {kOtherFailure, "wrong results, a promise that is not kept, a chip that stalls; any other failure"},
}};

}  // namespace raypool
