// The texts that are generated from the instruction table and checked in: rtl/isa.vh, rtl/isa_functions.vh, docs/isa.md.
#pragma once

#include <string>

namespace raypool {

/// rtl/isa.vh: constants, to be included inside a module body.
std::string isa_verilog();
/// rtl/isa_functions.vh: functions, to be included inside a module body; needs no constants.
std::string isa_verilog_functions();
/// docs/isa.md
std::string isa_markdown();

}  // namespace raypool
