// The modules of a SystemC simulation with their ports, exports and sockets, and what each is bound to.
#pragma once

#include <string>

namespace raypool::chip {

/// A line each, indented by depth, from SystemC's own tree of objects. Elaborates what has been built, without running
/// it.
std::string module_tree();

}  // namespace raypool::chip
