// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What several passes over intermediate code share.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "kernel/compiler.hpp"

namespace raypool::kernel {

/// For each virtual register (or predicate) its only defining op, kNothing if there are several or none.
std::vector<int> find_single_definitions(const Function& function, bool predicates);

/// An op that makes a predicate 0 in all lanes.
Op clearing(int predicate, const Location& where);

/// A pass that takes ops out, unless what is left finds no registers or predicates, as colouring tries but some ways.
template <typename Pass>
void apply_where_places_suffice(Function& function, const Pass& pass) {
  Function smaller = function;
  pass(smaller);
  if (has_places(smaller, false) && has_places(smaller, true)) function = std::move(smaller);
}

/// The operation that gives the same result with ra and rb exchanged, if there is one.
std::optional<Opcode> exchanged(Opcode opcode);

}  // namespace raypool::kernel
