// The texts that are generated from the tables of isa.hpp and checked in.
#pragma once

#include <string>
#include <vector>

#include "isa/isa.hpp"

namespace raypool {

/// rtl/isa.vh: constants, to be included inside a module body.
std::string isa_verilog();
/// rtl/isa_functions.vh: functions, to be included inside a module body; needs no constants.
std::string isa_verilog_functions();
/// docs/isa.md
std::string isa_markdown();

/// rtl/alu_parameters.vh: COUNT, LATENCY and DEPTH of each ALU type that has them, to be included in a parameter list.
std::string alu_parameters_verilog();
/// rtl/alu_parameter_map.vh: their connections, to be included where a module with these parameters is instantiated.
std::string alu_parameter_map_verilog();
/// rtl/alu_slots.vh: how many types, the first slot of each, the type of each slot; to be included inside the body of
/// compute_unit.
std::string alu_slots_verilog();
/// rtl/alu_instances.vh: the ALUs with the framework's ports, to be included inside a generate block of compute_unit.
std::string alu_instances_verilog();

struct GeneratedFile {
  std::string path;  ///< from the root of the checkout
  std::string text;
};
/// All of them.
std::vector<GeneratedFile> generated_files();

/// The type's name in upper case, as Verilog parameters and constants begin with it.
std::string verilog_name(AluType type);

}  // namespace raypool
