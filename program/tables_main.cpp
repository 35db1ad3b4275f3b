// The program `raypool-tables`: of `raypool` what `make isa` needs, made of the tables alone.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string>
#include <string_view>

#include "config/configuration.hpp"
#include "config/derived_files.hpp"

namespace {

constexpr const char* kUsage =
    "usage: raypool-tables --write                 write what is derived from the tables, in the root of the checkout\n"
    "       raypool-tables --verilog-parameters    print the Verilog parameters of configuration 8w8c\n";

int run(std::string_view option) {
  if (option == "--write") {
    for (const std::string& path : raypool::write_derived_files(".")) fmt::print("wrote {}\n", path);
  } else if (option == "--verilog-parameters") {
    for (const auto& [name, value] : raypool::verilog_parameters(raypool::load_configuration("8w8c")))
      fmt::print("{}={}\n", name, value);
  } else {
    std::fputs(kUsage, stderr);
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc == 2 ? argv[1] : "");
  } catch (const std::exception& error) {
    fmt::print(stderr, "raypool-tables: {}\n", error.what());
    return 1;
  }
}
