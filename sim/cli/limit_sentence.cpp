#include "cli/limit_sentence.hpp"

#include <fmt/format.h>

namespace raypool {

std::string limit_sentence(const LimitPassed& passed, bool given) {
  return fmt::format("{}{}; {}", passed.limit,
                     given ? "" : ", and no other limit was given: if it takes longer, set a limit with --cycles",
                     passed.rest);
}

}  // namespace raypool
