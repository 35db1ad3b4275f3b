// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a plain ALU computes: the golden model of a type that has a CLASS row in the table of
// isa.hpp. docs/develop/add-an-alu.md adds one.
#pragma once

#include <cstdint>

#include "arith/arith.hpp"
#include "isa/isa.hpp"

namespace raypool {

/// One lane's part of a task, as rtl/compute/rp_dispatcher.v hands it to the ALU.
struct LaneTask {
  uint32_t operand_a = 0;    ///< register ra
  uint32_t operand_b = 0;    ///< register rb, or the immediate
  uint32_t immediate = 0;    ///< the immediate, whatever operand_b is
  uint32_t word = 0;         ///< field x, 0 .. 31
  bool predicate_x = false;  ///< of the predicate numbered x[3:0]
  bool predicate_b = false;  ///< of the predicate numbered rb
};

/// A function of the task alone: no lane sees another one, nothing is kept from task to task.
class AluModel {
 public:
  virtual ~AluModel() = default;
  /// The word for rd of an instruction that writes a register; of one that writes a
  /// predicate, 0 or 1. `opcode` is of the type.
  virtual uint32_t lane(Opcode opcode, const LaneTask& task, arith::Mode mode) const = 0;
};

/// The model of a type with a CLASS row; its source file defines it, and the linker misses it otherwise.
template <AluType type>
const AluModel& alu_model();

#define RAYPOOL_CORE(type, name, depth, ports, parameters, title)
#define RAYPOOL_CLASS(type, name, depth, parameters, title) \
  template <>                                               \
  const AluModel& alu_model<AluType::type>();
RAYPOOL_ALU_TYPES(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS

/// The model of a type; null if FunctionalCore executes it itself.
const AluModel* find_alu_model(AluType type);

}  // namespace raypool
