// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/config/parameters.hpp by `raypool isa --write`; a test compares. Do not edit.
  generate
    if (DATA_CACHE_BYTES < 512 || DATA_CACHE_BYTES > 65536 ||
        (DATA_CACHE_BYTES & (DATA_CACHE_BYTES - 1)) != 0) begin : gen_bad_DATA_CACHE_BYTES
      DATA_CACHE_BYTES_must_be_a_power_of_two_from_512_to_65536 illegal ();
    end
    if (DATA_CACHE_MSHRS < 1 || DATA_CACHE_MSHRS > 16) begin : gen_bad_DATA_CACHE_MSHRS
      DATA_CACHE_MSHRS_must_be_an_integer_from_1_to_16 illegal ();
    end
  endgenerate
