// `raypool compare`
#include <fmt/format.h>

#include <filesystem>

#include "cli/folders.hpp"
#include "files/json_text.hpp"
#include "isa/input_error.hpp"
#include "tools/commands.hpp"
#include "tools/report_comparison.hpp"

namespace raypool {

int compare_command(const CompareOptions& options) {
  const Report a = load_report(options.a), b = load_report(options.b);
  std::vector<std::string> synthesis = options.synthesis;
  for (const std::string& place : synthesis) {
    std::error_code none;
    if (!std::filesystem::exists(place, none))
      throw InputError(fmt::format("--synthesis {}: there is no such file or folder", place));
  }
  if (synthesis.empty()) synthesis.push_back((results_folder().parent_path() / "synth").string());
  const nlohmann::ordered_json comparison = compare_reports(a, b, synthesis, options.map);
  fmt::print("{}", options.json ? to_text(comparison, 2) + "\n" : comparison_table(comparison));
  return 0;
}

}  // namespace raypool
