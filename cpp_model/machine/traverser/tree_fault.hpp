// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Why rtl/traverser/rp_traverser.v has stopped: its memory holds a malformed tree. Sticky, the first one.
#pragma once

#include <cstdint>

namespace raypool {

/// As fault_code_o has it.
enum class TreeFaultCode : uint8_t {
  NodeBeyond = 0,      ///< a node's line is asked for that lies behind the last one
  TriangleBeyond = 1,  ///< the same of triangles
  StackFull = 2,       ///< a ray's stack has no room left in the memory
  Children = 4,        ///< a node has not one to four children
  Order = 5,           ///< a child of a node is a node, and not of a higher number
  Visits = 6,          ///< a ray comes to more nodes than there are
};

struct TreeFault {
  bool valid = false;
  TreeFaultCode code = TreeFaultCode::NodeBeyond;
  uint32_t line = 0;  ///< of the traverser's memory, 64 bytes each; all ones of 26 bits: no address reaches it
};

}  // namespace raypool
