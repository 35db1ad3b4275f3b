// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Which words of the current ray slice, and which slots of spill memory, hold something that is needed.
#pragma once

#include <vector>

#include "kernel/intermediate.hpp"
#include "kernel/liveness.hpp"

namespace raypool::kernel {

/// Behind each op the places whose content some lane may need: word n of the current slice is n, slot n of spill memory
/// kPackageWords + n. A read needs its word, `rout` words 0 .. 11, `rfb` 7 .. 10, in the lanes of its guard; a write
/// gives the word a new content in the lanes of its own. For code without triples.
std::vector<NumberSet> find_needed_places(const Function& function);

/// The words that the op changes, a bit each: all of them where it swaps slices.
uint32_t words_changed(const Op& op);

}  // namespace raypool::kernel
