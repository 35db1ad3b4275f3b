// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Writes what is derived from the tables of instructions, ALU types, records, counters and parameters into a checkout.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace raypool {

/// Writes every derived file (generated_files(), generated_parameter_files()) whose text differs from what the tables
/// give; a file that is right keeps its time stamp. `root` is that of the checkout. Returns the paths of those that
/// were written, from the root. Throws InputError when `root` is no checkout, or a file cannot be read or written.
std::vector<std::string> write_derived_files(const std::filesystem::path& root);

}  // namespace raypool
