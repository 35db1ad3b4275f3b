// `raypool isa`
#include <cstdio>

#include "cli/commands.hpp"
#include "isa/reference.hpp"

namespace raypool {

int isa_command(IsaFormat format) {
  const std::string text = format == IsaFormat::Verilog            ? isa_verilog()
                           : format == IsaFormat::VerilogFunctions ? isa_verilog_functions()
                                                                   : isa_markdown();
  std::fputs(text.c_str(), stdout);
  return 0;
}

}  // namespace raypool
