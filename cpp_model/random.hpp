// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Random numbers of tests, random programs and samples: std::mt19937 with numbers that are words and need no cast.
#pragma once

#include <cstdint>
#include <random>

namespace raypool {

using Random = std::mersenne_twister_engine<uint32_t, 32, 624, 397, 31, 0x9908b0df, 11, 0xffffffff, 7, 0x9d2c5680, 15,
                                            0xefc60000, 18, 1812433253>;

}  // namespace raypool
