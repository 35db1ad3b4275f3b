// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Finds the program's own files, configs/, rtl/ and scripts/, and how it was called.
#pragma once

#include <string>

namespace raypool {

/// Whether the running program is an installed one: <prefix>/bin/... with <prefix>/share/raypool.
bool installed();

/// <prefix>/share/raypool of an installed program, else the checkout around the program's build folder, which
/// may be a copy of the one that this was compiled in.
std::string data_folder();

/// The program as it was called, for commands that a user is to type: "raypool" if PATH has it, else its path.
std::string program_command();

}  // namespace raypool
