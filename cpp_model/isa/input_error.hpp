// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The error of everything that is given something it cannot use.
#pragma once

#include <stdexcept>

namespace raypool {

/// A configuration, program or scene that cannot be used. what() is one sentence: what, where, what to do.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace raypool
