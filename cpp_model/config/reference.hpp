// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The texts that are generated from the table of parameters and checked in.
#pragma once

#include <string>
#include <vector>

#include "isa/reference.hpp"

namespace raypool {

/// schemas/configuration.json: the JSON Schema of configuration files.
std::string configuration_schema();

/// docs/machine/parameters.md
std::string parameters_markdown();

/// rtl/include/rp_*_parameters.vh, to be included in a parameter list; rtl/include/rp_*_parameter_map.vh, to be
/// included where a module with these parameters is instantiated; rtl/include/rp_*_parameter_checks.vh, to be included
/// inside the body of a module with them: * is unit, which has all parameters, or the name of a part, which has its
/// own.
std::vector<GeneratedFile> parameters_verilog();

/// All of them.
std::vector<GeneratedFile> generated_parameter_files();

}  // namespace raypool
