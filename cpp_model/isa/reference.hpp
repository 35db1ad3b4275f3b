// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The texts that are generated from the tables of isa.hpp, counters.hpp and records.hpp and checked in.
#pragma once

#include <string>
#include <vector>

#include "isa/isa.hpp"

namespace raypool {

/// rtl/include/rp_isa.vh: constants, to be included inside a module body.
std::string isa_verilog();
/// rtl/include/rp_isa_fields.vh: wires of the fields of an instruction, to be included inside a module body behind its
/// declaration.
std::string isa_fields_verilog();
/// rtl/include/rp_isa_functions.vh: functions, to be included inside a module body; needs no constants.
std::string isa_verilog_functions();
/// rtl/include/rp_counters.vh: numbers of the performance counters, to be included inside a module body.
std::string counters_verilog();
/// rtl/include/rp_records.vh: places of the fields of records, to be included inside a module body.
std::string records_verilog();
/// docs/machine/isa.md
std::string isa_markdown();

/// rtl/include/rp_alu_instance_types.vh: how many types and instances, the type of each instance; to be included inside
/// the body of compute_unit.
std::string alu_instance_types_verilog();
/// rtl/include/rp_alu_instances.vh: the ALUs with the framework's ports, to be included inside compute_unit's loop over
/// the instances.
std::string alu_instances_verilog();

/// How each file of rtl/ begins (scripts/licences.sh).
inline constexpr const char* kLicence =
    "// SPDX-License-Identifier: Apache-2.0\n"
    "// SPDX-FileCopyrightText: 2026 raypool maintainers\n";

struct GeneratedFile {
  std::string path;  ///< from the root of the checkout
  std::string text;
};
/// All of them.
std::vector<GeneratedFile> generated_files();

/// The type's name in upper case, as Verilog parameters and constants begin with it.
std::string verilog_name(AluType type);
/// Upper case.
std::string upper(std::string_view text);

}  // namespace raypool
