// `raypool isa`
#include <fmt/format.h>

#include <cstdio>

#include "config/derived_files.hpp"
#include "isa/reference.hpp"
#include "tools/commands.hpp"

namespace raypool {

int isa_command(IsaFormat format) {
  const std::string text = format == IsaFormat::Verilog            ? isa_verilog()
                           : format == IsaFormat::VerilogFunctions ? isa_verilog_functions()
                                                                   : isa_markdown();
  std::fputs(text.c_str(), stdout);
  return 0;
}

int isa_write_command() {
  for (const std::string& path : write_derived_files(".")) fmt::print("wrote {}\n", path);
  return 0;
}

}  // namespace raypool
