// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/config/parameters.hpp by `raypool isa --write`; a test compares. Do not edit.
  parameter integer DATA_CACHE_BYTES = 8192,
  parameter integer DATA_CACHE_MSHRS = 4,
