// `raypool isa`
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <utility>

#include "cli/text_file.hpp"
#include "config/reference.hpp"
#include "files/output_files.hpp"
#include "isa/input_error.hpp"
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
  if (!std::filesystem::exists("cpp_model/isa/isa.hpp"))
    throw InputError("there is no cpp_model/isa/isa.hpp here: run raypool isa --write in the root of the checkout");
  std::vector<GeneratedFile> files = generated_files();
  for (GeneratedFile& file : generated_parameter_files()) files.push_back(std::move(file));
  for (const GeneratedFile& file : files) {
    // What is right keeps its time stamp.
    if (std::filesystem::exists(file.path) && read_text(file.path) == file.text) continue;
    write_file(file.path, file.text);
    fmt::print("wrote {}\n", file.path);
  }
  return 0;
}

}  // namespace raypool
