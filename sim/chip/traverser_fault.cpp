#include "chip/traverser_fault.hpp"

#include <fmt/format.h>

#include "machine/chip/memory_port.hpp"
#include "machine/traverser/leaf_reader.hpp"

namespace raypool::chip {

namespace {

uint64_t byte_of(uint64_t line) { return line * raypool::MemoryLine::kBytes; }

std::string what(const TreeFault& fault, const TreeSetup& tree) {
  const uint64_t byte = byte_of(fault.line);
  switch (fault.code) {
    case TreeFaultCode::NodeBeyond:
      return fmt::format("a ray comes to node {}, at byte {} of the traverser's memory, and there are {} nodes",
                         fault.line, byte, tree.triangles_line);
    case TreeFaultCode::TriangleBeyond:
      if (fault.line == LeafReader::kLastLine) return "a leaf has triangles beyond all bytes of the traverser's memory";
      return fmt::format("a leaf has triangles at byte {} of the traverser's memory, and they end before byte {}", byte,
                         byte_of(uint64_t{tree.triangles_line} + tree.triangle_lines));
    case TreeFaultCode::StackFull:
      return fmt::format("the stack of a ray, up to byte {} of the traverser's memory, is full: the tree is too deep",
                         byte + raypool::MemoryLine::kBytes);
    case TreeFaultCode::Children:
      return fmt::format("node {}, at byte {} of the traverser's memory, has not one to four children", fault.line,
                         byte);
    case TreeFaultCode::Order:
      return fmt::format(
          "node {}, at byte {} of the traverser's memory, has a child with a number not above its own, from which a "
          "ray might come back for ever",
          fault.line, byte);
    case TreeFaultCode::Visits:
      return fmt::format(
          "a ray comes to more nodes than the {} that there are, at last to node {}, at byte {} of the traverser's "
          "memory: "
          "nodes have two parents, or the memory has not kept a stack",
          tree.triangles_line, fault.line, byte);
  }
  return fmt::format("code {}, line {}", static_cast<int>(fault.code), fault.line);
}

}  // namespace

std::string fault_sentence(const TreeFault& fault, const TreeSetup& tree) {
  return fmt::format(
      "the traverser has stopped with a fault: {}; write the tree there as docs/use/tree-file.md has it, and "
      "make sure that nothing else writes to that memory",
      what(fault, tree));
}

}  // namespace raypool::chip
