// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A pass for machines with triples, after all others.
#pragma once

#include "kernel/intermediate.hpp"

namespace raypool::kernel {

/// Makes up to `most` triples and returns how many. Their registers become groups of the function. Code between
/// threads' parting and meeting changes its order, and a register that is written once its number.
int form_triples(Function& function, int most);

}  // namespace raypool::kernel
