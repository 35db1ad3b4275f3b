// `raypool errors`
#include <cstdio>

#include "arith/error_table.hpp"
#include "cli/exit_code.hpp"
#include "tools/commands.hpp"

namespace raypool {

int errors_command(uint32_t grid) {
  const std::vector<arith::ErrorRow> rows = arith::error_table(grid);
  std::fputs(arith::to_text(rows).c_str(), stdout);
  for (const arith::ErrorRow& row : rows) {
    if (!arith::keeps_promise(row)) return kOtherFailure;
  }
  return kDone;
}

}  // namespace raypool
