// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/config/parameters.hpp by `raypool isa --write`; a test compares. Do not edit.
  generate
    if (INSTRUCTION_CACHE_BYTES < 512 || INSTRUCTION_CACHE_BYTES > 65536 ||
        (INSTRUCTION_CACHE_BYTES & (INSTRUCTION_CACHE_BYTES - 1)) != 0) begin : gen_bad_INSTRUCTION_CACHE_BYTES
      INSTRUCTION_CACHE_BYTES_must_be_a_power_of_two_from_512_to_65536 illegal ();
    end
  endgenerate
