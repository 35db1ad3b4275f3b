// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Machine code as the assembler and the kernel compiler hand it over.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace raypool {

/// Machine code from address 0, with the entry of each kernel in it (in instructions).
struct Program {
  std::vector<uint64_t> code;
  std::map<std::string, uint32_t> entries;
};

}  // namespace raypool
