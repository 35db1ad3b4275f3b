// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Finds the program's own files: configs/, rtl/, scripts/.
#pragma once

#include <string>

namespace raypool {

/// Whether the running program is an installed one: <prefix>/bin/... with <prefix>/share/raypool.
bool installed();

/// <prefix>/share/raypool of an installed program, else the checkout around the program's build folder, which
/// may be a copy of the one that this was compiled in.
std::string data_folder();

}  // namespace raypool
