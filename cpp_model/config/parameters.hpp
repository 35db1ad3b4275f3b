// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The one table of a machine's parameters: of the compute unit, and of the chip around it. Members of Configuration,
// the fields of a configuration file and its schema, docs/machine/parameters.md, parameter lists of the Verilog and
// their checks, raypool.core and the configurations that tests walk are derived from it. docs/develop/where.md adds a
// parameter.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace raypool {

/// None: as Flush, and where one arises the unit stops with a fault.
enum class Subnormals : uint8_t { Ieee = 0, Flush = 1, None = 2 };
enum class SlowUnit : uint8_t { Exact = 0, Newton2 = 1, Newton1 = 2, Newton0 = 3 };
/// What chooses the next kernel. Each name has its class in cpp_model/machine/.
enum class PolicyName : uint8_t { Thesis = 0, Fill = 1 };
enum class TileOrder : uint8_t { Rows = 0, Hilbert = 1 };
/// Static: the published one of constant speed, at the ports of rtl/chip/rp_chip.v. Hardware:
/// rtl/traverser/rp_traverser.v, inside it.
enum class TraverserName : uint8_t { Static = 0, Hardware = 1 };
/// What becomes of a shadow ray that reaches the light: an intersection, for the kernel `shade`, or a contribution.
enum class Shading : uint8_t { Kernel = 0, Traverser = 1 };

// A row: [part,] name, type in C++, default, values it may have, values that tests try, what it is.
//   UNIT(name, ...)        of the whole unit: `name` in configuration files and in C++, NAME in the Verilog
//   PART(part, name, ...)  of one part: `part.name` in files, part_name in C++, PART_NAME in the Verilog. Its modules
//                          include part_parameters.vh, and modules that instantiate them part_parameter_map.vh
//   ARITHMETIC(name, ...)  a mode of the arithmetic: `arithmetic.name` in files, name in C++, NAME in the Verilog
// clang-format off
#define RAYPOOL_PARAMETERS(UNIT, PART, ARITHMETIC) \
  UNIT(warps, uint32_t, 8, powers_of_two(1, 32), tried(1, 2, 4, 8, 16, 32), "warps of a compute unit") \
  UNIT(lanes, uint32_t, 8, powers_of_two(1, 32), tried(1, 2, 4, 8, 16, 32), "lanes of an ALU, and threads in a warp") \
  UNIT(stack_depth, uint32_t, 8, integers(2, 32), tried(2, 3, 8, 32), "entries of a warp's PC stack") \
  UNIT(triples, bool, false, on_or_off(), all(), "instructions that do three in one: rld3, ffma3 and others") \
  UNIT(kernel_overlap, bool, false, on_or_off(), all(), \
       "a warp that has ended goes on with the next kernel while others still run the one before") \
  UNIT(wide_ray_memory, bool, false, on_or_off(), all(), \
       "with more than four lanes: rld and rst move a word of all of them in a cycle, an import eight words") \
  UNIT(slow_lanes, uint32_t, 32, powers_of_two(1, 32), tried(1, 2, 32), \
       "lanes of an instance of slw at most: with fewer than the unit has, a task takes them one group after another") \
  UNIT(sharing, bool, false, on_or_off(), all(), \
       "instructions unit and inval, with which threads of several units share memory") \
  UNIT(intersection_words, uint32_t, 21, integers(12, 21), tried(12, 16, 21), \
       "words of an intersection on its port and in ray memory: 21, or those that the kernels need") \
  UNIT(registers, uint32_t, 16, integers(8, 16), tried(8, 12, 16), "registers of a thread, from r0 on") \
  UNIT(predicates, uint32_t, 16, integers(2, 16), tried(2, 5, 16), "predicates of a thread, from p0 on") \
  UNIT(arguments, uint32_t, 32, integers(4, 32), tried(4, 11, 32), "argument words of a kernel") \
  UNIT(pc_bits, uint32_t, 16, integers(8, 16), tried(8, 11, 16), \
       "bits of a PC: a program has fewer than 2^pc_bits instructions") \
  UNIT(counter_bits, uint32_t, 48, integers(16, 48), tried(16, 29, 48), "bits of a performance counter") \
  PART(instruction_cache, bytes, uint32_t, 4096, powers_of_two(512, 65536), tried(512, 1024, 4096, 65536), "size") \
  PART(data_cache, bytes, uint32_t, 8192, powers_of_two(512, 65536), tried(512, 1024, 8192, 65536), "size") \
  PART(data_cache, mshrs, uint32_t, 4, integers(1, 16), tried(1, 2, 3, 4, 16), \
       "miss-status holding registers: lines that may be on their way at once") \
  ARITHMETIC(subnormals, Subnormals, Subnormals::Ieee, names("ieee", "flush", "none"), all(), \
             "subnormal numbers: as in IEEE 754, or zero, or none: where one arises the unit stops with a fault") \
  ARITHMETIC(significand, uint32_t, 24, integers(11, 24), tried(11, 13, 16, 24), \
             "bits of a float's significand, with its leading one; what a word has below them counts as zero") \
  ARITHMETIC(slow_unit, SlowUnit, SlowUnit::Exact, names("exact", "newton2", "newton1", "newton0"), all(), \
             "how slw divides and takes roots: with one rounding, or by Newton's method of that many steps") \
  ARITHMETIC(fma, bool, false, on_or_off(), all(), "fused multiply-add: the instruction ffma") \
  /* The table ends here: the backslash above lets a row follow it. */

// The chip around the unit: no Verilated unit has any of it; some are parameters of its own modules in rtl/.
//   CHIP(name, ...)              `chip.name` in files, chip.name in C++
//   CHIP_PART(part, name, ...)   `chip.part.name` in files, chip.part_name in C++
// A beat is 128 bits, the width of the unit's ports: so 2 cycles a beat is a port of half that width.
#define RAYPOOL_CHIP_PARAMETERS(CHIP, CHIP_PART) \
  CHIP(policy, PolicyName, PolicyName::Thesis, names("thesis", "fill"), "what chooses the next kernel") \
  CHIP(window_remedy, bool, true, on_or_off(), "eye rays of further tiles are cast while earlier ones are under way") \
  CHIP(launch_ahead, bool, true, on_or_off(), "a kernel is launched behind a running one, if it is worth it") \
  CHIP(held_limit, uint32_t, 512, integers(1, 1 << 20), "unfinished pixels at a time") \
  CHIP(traverser, TraverserName, TraverserName::Hardware, names("static", "hardware"), \
       "the traverser: the published one of constant speed, or rtl/traverser/rp_traverser.v") \
  CHIP(tile_order, TileOrder, TileOrder::Rows, names("rows", "hilbert"), \
       "order in which tiles are cast: rows from the top, or along a Hilbert curve, each beside the last") \
  CHIP(shading, Shading, Shading::Kernel, names("kernel", "traverser"), \
       "what adds shadow rays that reach the light to the frame buffer: the kernel shade, or the traverser itself") \
  CHIP(reflections, bool, true, on_or_off(), "there is a kernel that casts reflections; without it a frame has none") \
  CHIP(culling, bool, false, on_or_off(), "rays that cannot add to the picture are left out") \
  CHIP(miss_records, bool, false, on_or_off(), \
       "a ray with the flag `returns` comes back as a package even if it meets nothing") \
  CHIP_PART(thresholds, rays, uint32_t, 48, integers(0, 1 << 20), \
            "rays in the ray pool above which no more are cast, for 64 contents and one unit") \
  CHIP_PART(thresholds, intersections, uint32_t, 8, integers(0, 1 << 20), \
            "intersections above which a kernel takes some, for 64 contents") \
  CHIP_PART(static_traverser, batch, uint32_t, 64, integers(1, 4096), \
            "rays traced when a kernel ends, or after a stall") \
  CHIP_PART(static_traverser, stall_cycles, uint32_t, 1000, integers(1, 1 << 20), \
            "cycles in which the shader stalls until a batch is traced") \
  CHIP_PART(hardware_traverser, box_bits, uint32_t, 12, integers(6, 16), \
            "bits of the integers in which boxes are tested") \
  CHIP_PART(hardware_traverser, rays, uint32_t, 128, integers(1, 1024), "rays in flight, of all lanes") \
  CHIP_PART(hardware_traverser, lanes, uint32_t, 4, integers(1, 31), \
            "lanes, each with a pipe that begins to test a node of four boxes in a cycle") \
  CHIP_PART(hardware_traverser, triangle_pipes, uint32_t, 2, integers(1, 31), \
            "triangle tests that begin in a cycle: pipes that lanes share") \
  CHIP_PART(hardware_traverser, stack_entries, uint32_t, 12, integers(8, 64), \
            "entries that a ray's stack keeps; older ones go to the memory, four at a time") \
  CHIP_PART(hardware_traverser, cache_banks, uint32_t, 8, powers_of_two(1, 16), \
            "banks of each cache: a line each in a cycle, for all lanes that want that line") \
  CHIP_PART(hardware_traverser, node_cache_bytes, uint32_t, 65536, powers_of_two(512, 1 << 24), \
            "size, in lines of a node, 64 bytes") \
  CHIP_PART(hardware_traverser, node_cache_ways, uint32_t, 4, powers_of_two(2, 16), "lines of a set") \
  CHIP_PART(hardware_traverser, node_cache_mshrs, uint32_t, 16, integers(1, 64), \
            "lines that may be on their way at once") \
  CHIP_PART(hardware_traverser, triangle_cache_bytes, uint32_t, 65536, powers_of_two(512, 1 << 24), \
            "size, in lines of 64 bytes") \
  CHIP_PART(hardware_traverser, triangle_cache_ways, uint32_t, 4, powers_of_two(2, 16), "lines of a set") \
  CHIP_PART(hardware_traverser, triangle_cache_mshrs, uint32_t, 16, integers(1, 64), \
            "lines that may be on their way at once") \
  CHIP_PART(ray_pool, size, uint32_t, 512, integers(1, 1 << 20), "rays that it holds") \
  CHIP_PART(ray_pool, overhead, uint32_t, 2, integers(1, 64), \
            "cycles that its port takes for a ray besides the 3 beats") \
  CHIP_PART(ray_pool, cycles_per_beat, uint32_t, 1, integers(1, 64), "cycles of its port for a beat of 128 bits") \
  CHIP_PART(ray_pool, pipelined, bool, false, on_or_off(), \
            "the overhead for the next ray runs while the beats of the last one move") \
  CHIP_PART(intersection_pool, size, uint32_t, 512, integers(1, 1 << 20), "intersections of each kind that it holds") \
  CHIP_PART(intersection_pool, overhead, uint32_t, 2, integers(1, 64), \
            "cycles that its port takes for an intersection besides the beats") \
  CHIP_PART(intersection_pool, cycles_per_beat, uint32_t, 1, integers(1, 64), \
            "cycles of its port for a beat of 128 bits") \
  CHIP_PART(intersection_pool, pipelined, bool, false, on_or_off(), \
            "the overhead for the next intersection runs while the beats of the last one move") \
  CHIP_PART(memory, latency, uint32_t, 120, integers(1, 10000), "cycles from a read's service to its last beat") \
  CHIP_PART(memory, cycles_per_beat, uint32_t, 2, integers(1, 64), "cycles of its port for a beat of 128 bits") \
  CHIP_PART(memory, queue, uint32_t, 8, integers(1, 64), "requests that wait at its port") \
  CHIP_PART(memory, banks, uint32_t, 16, powers_of_two(1, 64), "banks, each with a row open") \
  CHIP_PART(memory, row_bytes, uint32_t, 2048, powers_of_two(64, 65536), "size of a row") \
  CHIP_PART(memory, row_miss, uint32_t, 0, integers(0, 1000), \
            "cycles by which a line of a row that is not open comes later; 0: no rows") \
  /* The table ends here: the backslash above lets a row follow it. */

// What each ALU type has, but for mem and ray, which stand once and are timed by events: `alus.int.count` in files,
// alu(AluType::Int).count in C++, INT_COUNT in the Verilog. A depth begins at least_depth(), which is also its default.
#define RAYPOOL_ALU_PARAMETERS(ROW) \
  ROW(count, 1, integers(1, 4), tried(1, 2, 3, 4), "instances") \
  ROW(latency, 1, integers(1, 16), tried(1, 2, 3, 16), "cycles between new tasks") \
  ROW(depth, 1, integers(0, 32), tried(0, 1, 32), "pipeline stages") \
  ROW(without, 0, instructions(), all(), "instructions that it lacks, of those that a unit may lack") \
  /* The table ends here: the backslash above lets a row follow it. */
// clang-format on

/// The values that a parameter may have.
struct Range {
  enum class Form : uint8_t { Integer, PowerOfTwo, Name, OnOff, Instructions };
  Form form;
  int least, greatest;                      ///< of form Instructions: the greatest is the set of all
  std::array<std::string_view, 8> names{};  ///< of 0, 1, ... of form Name
  size_t alu = 0;                           ///< number of the type that has these instructions, of form Instructions

  constexpr bool has(int value) const {
    return value >= least && value <= greatest && (form != Form::PowerOfTwo || (value & (value - 1)) == 0) &&
           (form != Form::Instructions || (value & ~greatest) == 0);
  }
};

/// The values that tests try: the ends, and what lies between and matters. None: all that the parameter may have.
struct Tried {
  std::array<int, 8> values{};
  size_t count = 0;
};

/// What the rows are written with.
namespace parameter {
inline constexpr Range integers(int least, int greatest) { return {Range::Form::Integer, least, greatest}; }
inline constexpr Range powers_of_two(int least, int greatest) { return {Range::Form::PowerOfTwo, least, greatest}; }
inline constexpr Range on_or_off() { return {Range::Form::OnOff, 0, 1}; }
/// A set of a type's instructions, a bit for each operation number; which they may be differs from type to type.
inline constexpr Range instructions() { return {Range::Form::Instructions, 0, 0}; }
template <typename... Names>
constexpr Range names(Names... of_values) {
  return {Range::Form::Name, 0, int{sizeof...(Names)} - 1, {of_values...}};
}

inline constexpr Tried all() { return {}; }
template <typename... Values>
constexpr Tried tried(Values... values) {
  return {{values...}, sizeof...(Values)};
}
}  // namespace parameter

}  // namespace raypool
