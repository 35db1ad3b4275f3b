// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The area of any machine without synthesis: sums of terms, fitted to blocks of synthesised machines. `make areas`
// makes the table, docs/studies/explore.md has its errors.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "config/configuration.hpp"

namespace raypool::explore {

class AreaTable {
 public:
  /// `text`: of the table's file. Throws InputError, which begins with `file`, for one that is not such a table.
  AreaTable(const std::string& text, const std::string& file);

  /// mm2 at 40 nm of a chip of so many units, its traverser inside; 0 units: of a unit alone. Throws InputError for a
  /// term that names no field.
  double area_of(const Configuration& configuration, uint32_t units) const;

 private:
  struct Factor {
    std::string field;
    std::string value;  ///< 1 where the field has it, else 0; empty: the field's number
  };
  struct Term {
    std::vector<Factor> factors;
    bool root = false;  ///< of their product
    double mm2 = 0;
  };
  struct Block {
    bool of_unit = false;
    std::vector<Term> terms;
  };

  std::string file_;
  std::vector<Block> blocks_;
};

/// Where a program finds the table that the project made.
std::string area_table_path();

}  // namespace raypool::explore
