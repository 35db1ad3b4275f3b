// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The Verilated rtl/chip/rp_chip.v behind the interface of the chip. scripts/verilate.sh --top chip compiles it into a
// shared library. What the blocks show each other is read from the wires between them, which sim/rtl/chip_probes.vlt
// keeps.
#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "Vchip.h"
#include "Vchip___024root.h"
#include "bits.hpp"
#include "built_parameters.h"
#include "machine/common/packages.hpp"
#include "rtl/chip_library.hpp"
#include "rtl/verilated_design.hpp"

namespace raypool {
namespace {

constexpr uint32_t kUnitCount = RAYPOOL_UNIT_COUNT;
using Wires = Vchip___024root;

/// The multiprocessor's output ports, by the wires that are connected to them.
struct DevicePorts {
#define RAYPOOL_DEVICE_PORTS(X)                       \
  X(launch_ready_o, launch_ready)                     \
  X(launch_unit_o, launch_unit)                       \
  X(kernel_done_o, kernel_done)                       \
  X(busy_o, unit_busy)                                \
  X(idle_o, unit_idle)                                \
  X(exports_o, exports)                               \
  X(memory_request_valid_o, device_request_valid)     \
  X(memory_request_write_o, device_request_write)     \
  X(memory_request_address_o, device_request_address) \
  X(memory_request_data_o, device_request_data)       \
  X(memory_request_mask_o, device_request_mask)       \
  X(memory_request_id_o, device_request_id)           \
  X(import_request_valid_o, import_request_valid)     \
  X(import_request_kind_o, import_request_kind)       \
  X(import_request_unit_o, import_request_unit)       \
  X(export_valid_o, export_valid)                     \
  X(export_data_o, export_data)                       \
  X(export_last_o, export_last)                       \
  X(export_unit_o, export_unit)                       \
  X(frame_valid_o, unit_frame_valid)                  \
  X(frame_pixel_o, unit_frame_pixel)                  \
  X(frame_color_o, unit_frame_color)                  \
  X(frame_unit_o, unit_frame_unit)
#define RAYPOOL_MEMBER(port, wire) const decltype(Wires::rp_chip__DOT__##wire)& port;
#define RAYPOOL_BIND(port, wire) port(wires.rp_chip__DOT__##wire),
  RAYPOOL_DEVICE_PORTS(RAYPOOL_MEMBER)
  const CData &fault_valid_o, &fault_code_o, &fault_warp_o;
  const SData& fault_pc_o;
  const CData& fault_unit_o;

  DevicePorts(const Vchip& top, const Wires& wires)
      : RAYPOOL_DEVICE_PORTS(RAYPOOL_BIND) fault_valid_o(top.fault_valid_o),
        fault_code_o(top.fault_code_o),
        fault_warp_o(top.fault_warp_o),
        fault_pc_o(top.fault_pc_o),
        fault_unit_o(top.fault_unit_o) {}
#undef RAYPOOL_BIND
#undef RAYPOOL_MEMBER
#undef RAYPOOL_DEVICE_PORTS
};

/// Lanes that the caches of a traverser inside give a line.
struct LinesGiven {
  uint32_t nodes, leaves;
};
// Without a traverser these wires do not exist, and in a netlist nothing but the top's wires can be found.
template <typename AnyWires>
auto lines_given(const AnyWires& w, int /*preferred*/)
    -> decltype(w.rp_chip__DOT__gen_inside__DOT__traverser__DOT__node_given, LinesGiven()) {
  return {w.rp_chip__DOT__gen_inside__DOT__traverser__DOT__node_given,
          w.rp_chip__DOT__gen_inside__DOT__traverser__DOT__leaf_given};
}
template <typename AnyWires>
LinesGiven lines_given(const AnyWires& /*w*/, long /*otherwise*/) {
  return {ChipOutputs::kNotSeen, ChipOutputs::kNotSeen};
}

class RtlChip : public ChipDevice {
 public:
  explicit RtlChip(const Configuration& configuration)
      : inside_(has_traverser(configuration.chip)),
        arguments_(configuration.arguments),
        kinds_(configuration.chip.culling ? 3 : 2),
        level_bits_(32u - static_cast<uint32_t>(__builtin_clz(configuration.chip.intersection_pool_size))) {}

  uint32_t units() const override { return kUnitCount; }

  void start(const FrameSetup& setup) override {
    Vchip& top = design_.top();
    write_setup(setup);
    starts_ = false;
    top.rst_ni = 0;
    clock({});
    top.rst_ni = 1;
    clock({});
    write_arguments();
  }

  void start_next(const FrameSetup& setup) override {
    check_next(setup_, setup, out_);
    write_setup(setup);
    write_arguments();
  }

  const ChipOutputs& outputs() const override { return out_; }

  void clock(const ChipInputs& inputs) override {
    write_inputs(inputs);
    design_.clock();
    starts_ = false;
    read_outputs();
  }

  void settle(const ChipInputs& inputs) override {
    write_inputs(inputs);
    design_.settle();
  }

  ChipCounts counts() override {
    const Vchip& top = design_.top();
    return {top.rays_taken_o,   top.ray_port_busy_o, top.packages_taken_o,  top.contributions_o,
            top.memory_reads_o, top.memory_writes_o, top.memory_port_busy_o};
  }
  uint64_t counter(int number) override { return read_counter(design_.top(), kUnitCount, number); }
  void open_waveform(const std::string& path) override { design_.open_waveform(path); }
  Signal signal(const std::string& scope, const std::string& name) const override {
    return design_.signal(scope, name);
  }

 private:
  void write_setup(const FrameSetup& setup) {
    if (!setup.tiles.empty()) throw std::logic_error("the chip in Verilog casts every tile: draw some with its model");
    setup_ = setup;
    Vchip& top = design_.top();
    top.program_length_i = static_cast<SData>(setup.program_length);
    top.memory_limit_i = setup.memory_limit;
    top.width_i = static_cast<SData>(setup.width);
    top.height_i = static_cast<SData>(setup.height);
    top.depth_limit_i = static_cast<CData>(setup.depth);
    top.reflections_i = setup.reflections;
    top.eye_pc_i = static_cast<SData>(setup.entries[RayKernel::CastEye]);
    top.secondary_pc_i = static_cast<SData>(setup.entries[RayKernel::CastSecondary]);
    top.direct_pc_i = static_cast<SData>(setup.entries[RayKernel::CastSecondaryDirect]);
    top.shade_pc_i = static_cast<SData>(setup.entries[RayKernel::Shade]);
    write_tree(setup.tree);
  }

  // The frame begins in the cycle behind them.
  void write_arguments() {
    Vchip& top = design_.top();
    top.argument_write_i = 1;
    for (uint32_t index = 0; index < arguments_; ++index) {
      top.argument_index_i = static_cast<CData>(index);
      top.argument_data_i = setup_.arguments[index];
      clock({});
    }
    top.argument_write_i = 0;
    starts_ = true;
  }

  void write_tree(const TreeSetup& tree) {
    Vchip& top = design_.top();
    top.tree_root_i = tree.root;
    for (size_t axis = 0; axis < 3; ++axis) {
      top.tree_lower_i.data()[axis] = as_bits(tree.bounds.lower[axis]);
      top.tree_upper_i.data()[axis] = as_bits(tree.bounds.upper[axis]);
    }
    top.triangles_line_i = tree.triangles_line;
    top.triangle_lines_i = tree.triangle_lines;
    top.stacks_line_i = tree.stacks_line;
    top.material_base_i = tree.material_base;
    constexpr uint32_t kBits = 5;
    const std::array<uint8_t, kIntersectionWords> words = words_of(tree.layout);
    std::array<uint32_t, 4> record{};
    for (uint32_t bit = 0; bit < kBits * words.size(); ++bit)
      record[bit / 32] |= (uint32_t{words[bit / kBits]} >> bit % kBits & 1) << bit % 32;
    std::copy(record.begin(), record.end(), top.record_i.data());
  }

  void write_inputs(const ChipInputs& in) {
    Vchip& top = design_.top();
    top.start_i = starts_ || in.start;
    top.memory_request_ready_i = in.memory_request_ready;
    top.memory_beat_valid_i = in.memory_beat_valid;
    if (in.memory_beat_valid) write_beat(top.memory_beat_data_i, in.memory_beat_data);
    top.frame_ready_i = in.frame_ready;
    top.ray_ready_i = in.ray_ready;
    top.free_valid_i = in.free_valid;
    // Widths of these are the pool's.
    top.free_place_i = static_cast<std::remove_reference_t<decltype(top.free_place_i)>>(in.free_place);
    top.free_shadow_i = in.free_shadow;
    top.put_valid_i = in.put_valid;
    if (in.put_valid) {
      top.put_kind_i = static_cast<CData>(in.put_kind);
      write_beat(top.put_data_i, in.put_data);
    }
    top.contribution_valid_i = in.contribution_valid;
    if (in.contribution_valid) {
      top.contribution_pixel_i = in.contribution.pixel;
      for (uint32_t i = 0; i < 3; ++i) top.contribution_color_i.data()[i] = in.contribution.rgb[i];
    }
    top.tree_request_valid_i = in.tree_request_valid;
    if (!in.tree_request_valid) return;
    top.tree_request_write_i = in.tree_request.write;
    top.tree_request_second_i = in.tree_request.second;
    top.tree_request_address_i = in.tree_request.address;
    for (uint32_t i = 0; i < 2 * kBeatWords; ++i)
      top.tree_request_data_i.data()[i] = in.tree_request.data[i / kBeatWords][i % kBeatWords];
  }

  void read_outputs() {
    const Vchip& top = design_.top();
    out_.ready = top.ready_o;
    out_.busy = top.busy_o;
    out_.memory_request_valid = top.memory_request_valid_o;
    if (out_.memory_request_valid) {
      MemoryRequest& request = out_.memory_request.request;
      out_.memory_request.traverser = top.memory_request_traverser_o;
      request.write = top.memory_request_write_o;
      request.address = top.memory_request_address_o;
      request.mask = top.memory_request_mask_o;
      if (request.write) read_beat(top.memory_request_data_o, request.data);
    }
    out_.memory_beat_ready = top.memory_beat_ready_o;
    out_.frame_valid = top.frame_valid_o;
    if (out_.frame_valid) {
      out_.frame.pixel = top.frame_pixel_o;
      read_color(top.frame_color_o, out_.frame);
    }
    read_unit_outputs(device_, kUnitCount, out_.device);
    read_device_inputs();
    read_between();
    read_to_traverser();
    if (!inside_) return;
    read_traverser();
    const LinesGiven given = lines_given(wires_, 0);
    out_.nodes_given = given.nodes;
    out_.leaves_given = given.leaves;
    out_.tree_fault.valid = top.tree_fault_valid_o;
    if (!out_.tree_fault.valid) return;
    out_.tree_fault.code = static_cast<TreeFaultCode>(top.tree_fault_code_o);
    out_.tree_fault.line = top.tree_fault_line_o;
  }

  // Whether it is inside or not.
  void read_to_traverser() {
    const Wires& w = wires_;
    out_.ray_valid = w.rp_chip__DOT__ray_valid;
    if (out_.ray_valid) {
      out_.ray_last = w.rp_chip__DOT__ray_last;
      out_.ray_place = w.rp_chip__DOT__ray_place;
      read_beat(w.rp_chip__DOT__ray_data, out_.ray_data);
    }
    out_.put_ready = uint32_t{w.rp_chip__DOT__put_ready} << to_underlying(ImportKind::Normal);
    out_.contribution_ready = w.rp_chip__DOT__contribution_ready;
    out_.tree_request_ready = w.rp_chip__DOT__tree_request_ready;
    out_.tree_response_valid = w.rp_chip__DOT__tree_response_valid;
    if (!out_.tree_response_valid) return;
    out_.tree_response_beat = w.rp_chip__DOT__tree_response_beat;
    read_beat(w.rp_chip__DOT__tree_response_data, out_.tree_response_data);
  }

  void read_traverser() {
    const Wires& w = wires_;
    TraverserPorts& ports = out_.traverser;
    ports.ray_ready = w.rp_chip__DOT__ray_ready;
    ports.free_valid = w.rp_chip__DOT__free_valid;
    ports.free_place = w.rp_chip__DOT__free_place;
    ports.free_shadow = w.rp_chip__DOT__free_shadow;
    ports.put_valid = w.rp_chip__DOT__put_valid;
    if (ports.put_valid) {
      ports.put_kind = static_cast<ImportKind>(w.rp_chip__DOT__put_kind);
      read_beat(w.rp_chip__DOT__put_data, ports.put_data);
    }
    ports.contribution_valid = w.rp_chip__DOT__contribution_valid;
    if (ports.contribution_valid) {
      ports.contribution.pixel = w.rp_chip__DOT__contribution_pixel;
      read_color(w.rp_chip__DOT__contribution_color, ports.contribution);
    }
    ports.tree_request_valid = w.rp_chip__DOT__tree_request_valid;
    if (!ports.tree_request_valid) return;
    ports.tree_request.write = w.rp_chip__DOT__tree_request_write;
    ports.tree_request.second = w.rp_chip__DOT__tree_request_second;
    ports.tree_request.address = w.rp_chip__DOT__tree_request_address;
    for (uint32_t i = 0; i < 2 * kBeatWords; ++i)
      ports.tree_request.data[i / kBeatWords][i % kBeatWords] = w.rp_chip__DOT__tree_request_data.data()[i];
  }

  void read_device_inputs() {
    const Wires& w = wires_;
    UnitInputs& in = out_.to_device;
    in.launch_valid = w.rp_chip__DOT__launch_valid;
    if (in.launch_valid) {
      in.launch = {w.rp_chip__DOT__launch_pc, w.rp_chip__DOT__launch_threads, w.rp_chip__DOT__launch_block, 1,
                   static_cast<ImportKind>(w.rp_chip__DOT__launch_import)};
    }
    in.memory_request_ready = w.rp_chip__DOT__device_request_ready;
    in.memory_response_valid = w.rp_chip__DOT__device_response_valid;
    if (in.memory_response_valid) {
      in.memory_response.id = w.rp_chip__DOT__device_response_id;
      in.memory_response.beat = w.rp_chip__DOT__device_response_beat;
      read_beat(w.rp_chip__DOT__device_response_data, in.memory_response.data);
    }
    in.import_request_ready = w.rp_chip__DOT__import_request_ready;
    in.import_beat_valid = w.rp_chip__DOT__import_beat_valid;
    if (in.import_beat_valid) read_beat(w.rp_chip__DOT__import_beat_data, in.import_beat);
    in.export_ready = w.rp_chip__DOT__export_ready;
    in.frame_ready = w.rp_chip__DOT__unit_frame_ready;
  }

  void read_between() {
    const Wires& w = wires_;
    out_.outcome.valid = w.rp_chip__DOT__outcome_valid;
    if (out_.outcome.valid) {
      out_.outcome = {true,
                      w.rp_chip__DOT__outcome_kept != 0,
                      w.rp_chip__DOT__outcome_deep != 0,
                      w.rp_chip__DOT__outcome_shadow != 0,
                      w.rp_chip__DOT__outcome_eye != 0,
                      w.rp_chip__DOT__outcome_unit,
                      w.rp_chip__DOT__outcome_pixel};
    }
    out_.rays = w.rp_chip__DOT__rays;
    out_.shadow_rays = w.rp_chip__DOT__shadow_rays;
    out_.held_up = w.rp_chip__DOT__ray_held_up && out_.device.export_valid;
    for (uint32_t kind = 0; kind < kinds_; ++kind) {
      const auto of = static_cast<ImportKind>(kind + 1);
      out_.size[of] = bits(w.rp_chip__DOT__size, kind * level_bits_, level_bits_);
      out_.available[of] = bits(w.rp_chip__DOT__available, kind * level_bits_, level_bits_);
    }
    out_.reserve_valid = w.rp_chip__DOT__reserve_valid;
    out_.reserve_kind = static_cast<ImportKind>(w.rp_chip__DOT__reserve_kind);
    out_.reserve_count = w.rp_chip__DOT__reserve_count;
    out_.pixel_valid = w.rp_chip__DOT__pixel_valid;
    out_.pixel_unit = w.rp_chip__DOT__pixel_unit;
    out_.exported_valid = w.rp_chip__DOT__exported_valid;
    out_.exported_unit = w.rp_chip__DOT__exported_unit;
    out_.exported_pixel = w.rp_chip__DOT__exported_pixel;
    out_.quiet = w.rp_chip__DOT__quiet & ((1u << kUnitCount) - 1);
  }

  bool inside_;  // the traverser
  uint32_t arguments_, kinds_;
  uint32_t level_bits_;  // of the intersection pool
  VerilatedDesign<Vchip> design_{"rp_chip"};
  const Wires& wires_ = *design_.top().rootp;
  DevicePorts device_{design_.top(), wires_};
  FrameSetup setup_;
  bool starts_ = false;  // the next cycle begins a frame
  ChipOutputs out_;
};

}  // namespace
}  // namespace raypool

RAYPOOL_EXPORT raypool::ChipDevice* raypool_create_chip(const raypool::Configuration& configuration) {
  return new raypool::RtlChip(configuration);
}
RAYPOOL_EXPORT const char* raypool_chip_parameters() { return RAYPOOL_BUILT_PARAMETERS; }
RAYPOOL_EXPORT const char* raypool_chip_interface() {
  static const std::string kText = raypool::chip_interface();
  return kText.c_str();
}
