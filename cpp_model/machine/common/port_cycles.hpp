// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The pools' and memory's ports give the cycle in which something happens, so that they need not be asked in the
// others.
#pragma once

#include <cstdint>

namespace raypool {

inline constexpr uint64_t kNever = UINT64_MAX;  ///< the cycle of what does not happen

}  // namespace raypool
