// `raypool asm` and `raypool disasm`. The file between them holds an instruction a line, 16 hexadecimal digits, and a
// line "// kernel NAME" before each kernel's first: what Verilog's $readmemh reads.
#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <sstream>

#include "bits.hpp"
#include "cli/text_file.hpp"
#include "files/output_files.hpp"
#include "isa/assembler.hpp"
#include "isa/input_error.hpp"
#include "tools/commands.hpp"

namespace raypool {
namespace {

constexpr std::string_view kKernelMark = "// kernel ";

void write_text(const std::string& out, const std::string& text) {
  if (out.empty()) {
    std::fputs(text.c_str(), stdout);
    return;
  }
  write_file(out, text);
}

Program parse_words(const std::string& text, const std::string& name) {
  Program program;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.compare(0, kKernelMark.size(), kKernelMark) == 0) {
      program.entries[line.substr(kKernelMark.size())] = size32(program.code);
      continue;
    }
    if (line.empty()) continue;
    uint64_t word = 0;
    const char* const end = line.data() + line.size();
    const auto [stop, error] = std::from_chars(line.data(), end, word, 16);
    if (error != std::errc{} || stop != end) {
      throw InputError(
          fmt::format("{}:{}: '{}' is not an instruction of up to 16 hexadecimal digits: give what raypool asm wrote",
                      name, number, line));
    }
    program.code.push_back(word);
  }
  return program;
}

}  // namespace

int asm_command(const std::string& path, const std::string& out) {
  const Program program = assemble(read_text(path), path);
  std::string text;
  for (size_t i = 0; i < program.code.size(); ++i) {
    for (const auto& [name, entry] : program.entries) {
      if (entry == i) text += fmt::format("{}{}\n", kKernelMark, name);
    }
    text += fmt::format("{:016x}\n", program.code[i]);
  }
  write_text(out, text);
  return 0;
}

int disasm_command(const std::string& path, const std::string& out) {
  write_text(out, listing(parse_words(read_text(path), path)));
  return 0;
}

}  // namespace raypool
