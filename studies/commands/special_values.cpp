#include "commands/special_values.hpp"

#include <fmt/format.h>

#include "cli/frame.hpp"
#include "isa/assembler.hpp"

namespace raypool {

SpecialValues special_values(const SpecialCensus& census, const Program& program) {
  SpecialValues found;
  for (uint32_t pc = 0; pc < census.counts().size(); ++pc) {
    const SpecialCounts& counts = census.counts()[pc];
    found.operations += counts.executed;
    found.instructions += counts.executed > 0 ? 1 : 0;
    if (counts.any()) found.places.push_back({kernel_at(program, pc), disassemble(program.code.at(pc)), pc, counts});
  }
  return found;
}

std::string text_of(const SpecialValues& specials) {
  std::string text = fmt::format("specials  infinities and NaNs at {} of {} float instructions, in {} operations\n",
                                 specials.places.size(), specials.instructions, specials.operations);
  if (specials.places.empty()) return text;
  constexpr const char* kRow = "{:<40} {:>10} {:>17} {:>9} {:>13} {:>9}\n";
  text += fmt::format(kRow, "", "executed", "infinite operands", "results", "NaN operands", "results");
  for (const auto& [kernel, instruction, pc, counts] : specials.places) {
    text += fmt::format(kRow, fmt::format("{} {}: {}", kernel, pc, instruction), counts.executed,
                        counts.infinite_operands, counts.infinite_results, counts.nan_operands, counts.nan_results);
  }
  return text;
}

nlohmann::ordered_json json_of(const SpecialValues& specials) {
  nlohmann::ordered_json json = {{"operations", specials.operations}, {"instructions", specials.instructions}};
  json["places"] = nlohmann::ordered_json::array();
  for (const auto& [kernel, instruction, pc, counts] : specials.places) {
    json["places"].push_back({{"kernel", kernel},
                              {"pc", pc},
                              {"instruction", instruction},
                              {"executed", counts.executed},
                              {"infinite_operands", counts.infinite_operands},
                              {"infinite_results", counts.infinite_results},
                              {"nan_operands", counts.nan_operands},
                              {"nan_results", counts.nan_results}});
  }
  return json;
}

}  // namespace raypool
