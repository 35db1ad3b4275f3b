#include "lockstep/chip_comparison.hpp"

#include <fmt/format.h>

#include <string>
#include <type_traits>

#include "bits.hpp"
#include "lockstep/rtl_files.hpp"

namespace raypool::lockstep {
namespace {

template <typename Value>
std::string text_of(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return std::to_string(to_underlying(value));
  } else {
    return std::to_string(value);
  }
}
std::string text_of(const Beat& beat) {
  return fmt::format("{:08x} {:08x} {:08x} {:08x}", beat[3], beat[2], beat[1], beat[0]);
}
std::string text_of(const std::array<uint32_t, 3>& rgb) {
  return fmt::format("{:08x} {:08x} {:08x}", rgb[0], rgb[1], rgb[2]);
}

/// Of one cycle.
class Ports {
 public:
  /// Ports of a block come next: its file's name in rtl/.
  void of(const char* block) { block_ = block; }
  /// True if both show the same.
  template <typename Value>
  bool same(const char* port, const Value& rtl, const Value& model) {
    if (rtl == model) return true;
    differs(port, text_of(rtl), text_of(model));
    return false;
  }
  /// The same of a word that is an address, or an instruction's.
  bool same_word(const char* port, uint32_t rtl, uint32_t model) {
    if (rtl == model) return true;
    differs(port, fmt::format("{:08x}", rtl), fmt::format("{:08x}", model));
    return false;
  }
  /// True if both are valid: then what goes with it is compared.
  bool both(const char* port, bool rtl, bool model) { return same(port, rtl, model) && rtl; }

  void finish() const {
    if (title_.empty()) return;
    throw Mismatch{title_, rows_, files(), Context::Unit};
  }

 private:
  // The block, or what in it drives its port; and what joins the blocks.
  std::string files() const {
    if (first_block_ == "controller" && first_port_ == "launch_block")
      return "rtl/chip/rp_tile_walk.v, rtl/chip/rp_chip.v";
    if (first_port_ == "node_given" || first_port_ == "leaf_given")
      return "rtl/traverser/rp_tree_banks.v, rtl/traverser/rp_tree_cache.v";
    return rtl_files({first_block_, "chip"});
  }
  void differs(const char* port, const std::string& rtl, const std::string& model) {
    if (title_.empty()) {
      title_ = fmt::format("{} of {} is {} in the RTL, {} in the model", port, block_, rtl, model);
      first_block_ = block_;
      first_port_ = port;
    }
    rows_ += fmt::format("  {:<40} RTL {:<36} model {}\n", fmt::format("{}.{}", block_, port), rtl, model);
  }

  const char* block_ = "";
  std::string title_, first_block_, first_port_, rows_;
};

void compare_request(Ports& ports, const MemoryRequest& rtl, const MemoryRequest& model, bool with_id) {
  if (!ports.same("memory_request_write", rtl.write, model.write)) return;
  ports.same_word("memory_request_address", rtl.address, model.address);
  if (with_id) {
    const bool write = model.write;  // its id is the unit's alone
    ports.same("memory_request_id", write ? unit_of_id(rtl.id) : rtl.id, write ? unit_of_id(model.id) : model.id);
  }
  if (!model.write) return;
  ports.same("memory_request_mask", rtl.mask, model.mask);
  Beat shown = model.data;
  for (uint32_t i = 0; i < kBeatWords; ++i)
    if ((model.mask >> i & 1) != 0) shown[i] = rtl.data[i];
  ports.same("memory_request_data", shown, model.data);
}

void compare_device(Ports& ports, const UnitOutputs& rtl, const UnitOutputs& model) {
  ports.of("multiprocessor");
  ports.same("fault_code", rtl.fault.code, model.fault.code);
  if (rtl.fault.code != FaultCode::None && model.fault.code != FaultCode::None) {
    ports.same("fault_unit", rtl.fault.unit, model.fault.unit);
    ports.same("fault_warp", rtl.fault.warp, model.fault.warp);
    ports.same("fault_pc", rtl.fault.pc, model.fault.pc);
  }
  if (ports.both("launch_ready", rtl.launch_ready, model.launch_ready))
    ports.same("launch_unit", rtl.launch_unit, model.launch_unit);
  ports.same("kernel_done", rtl.kernel_done, model.kernel_done);
  ports.same("busy", rtl.busy, model.busy);
  ports.same("idle", rtl.unit_idle, model.unit_idle);
  for (uint32_t unit = 0; unit < kMostUnits; ++unit) ports.same("exports", rtl.exports[unit], model.exports[unit]);
  if (ports.both("memory_request_valid", rtl.memory_request_valid, model.memory_request_valid))
    compare_request(ports, rtl.memory_request, model.memory_request, true);
  if (ports.both("import_request_valid", rtl.import_request_valid, model.import_request_valid)) {
    ports.same("import_request_kind", rtl.import_request_kind, model.import_request_kind);
    ports.same("import_request_unit", rtl.import_request_unit, model.import_request_unit);
  }
  if (ports.both("export_valid", rtl.export_valid, model.export_valid)) {
    ports.same("export_data", rtl.export_data, model.export_data);
    ports.same("export_last", rtl.export_last, model.export_last);
    ports.same("export_unit", rtl.export_unit, model.export_unit);
  }
  if (ports.both("frame_valid", rtl.frame_valid, model.frame_valid)) {
    ports.same_word("frame_pixel", rtl.frame.pixel, model.frame.pixel);
    ports.same("frame_color", rtl.frame.rgb, model.frame.rgb);
    ports.same("frame_unit", rtl.frame_unit, model.frame_unit);
  }
}

void compare_controller(Ports& ports, const ChipOutputs& rtl, const ChipOutputs& model) {
  ports.of("chip");
  ports.same("ready", rtl.ready, model.ready);
  ports.of("controller");
  ports.same("busy", rtl.busy, model.busy);
  if (ports.both("launch_valid", rtl.to_device.launch_valid, model.to_device.launch_valid)) {
    const LaunchCommand &r = rtl.to_device.launch, &m = model.to_device.launch;
    ports.same("launch_pc", r.pc, m.pc);
    ports.same("launch_threads", r.threads, m.threads);
    ports.same("launch_import", r.import, m.import);
    // Kernels that import know of no block.
    if (m.import == ImportKind::None) ports.same_word("launch_block", r.block, m.block);
    ports.same("launch_blocks", r.blocks, m.blocks);
  }
  if (ports.both("reserve_valid", rtl.reserve_valid, model.reserve_valid)) {
    ports.same("reserve_kind", rtl.reserve_kind, model.reserve_kind);
    ports.same("reserve_count", rtl.reserve_count, model.reserve_count);
  }
}

void compare_rays(Ports& ports, const ChipOutputs& rtl, const ChipOutputs& model) {
  ports.of("ray_pool");
  ports.same("export_ready", rtl.to_device.export_ready, model.to_device.export_ready);
  if (ports.both("outcome_valid", rtl.outcome.valid, model.outcome.valid)) {
    ports.same("outcome_kept", rtl.outcome.kept, model.outcome.kept);
    ports.same("outcome_deep", rtl.outcome.deep, model.outcome.deep);
    ports.same("outcome_shadow", rtl.outcome.shadow, model.outcome.shadow);
    ports.same("outcome_eye", rtl.outcome.eye, model.outcome.eye);
    ports.same("outcome_unit", rtl.outcome.unit, model.outcome.unit);
    ports.same_word("outcome_pixel", rtl.outcome.pixel, model.outcome.pixel);
  }
  ports.same("rays", rtl.rays, model.rays);
  ports.same("shadow_rays", rtl.shadow_rays, model.shadow_rays);
  ports.same("held_up", rtl.held_up, model.held_up);
  if (ports.both("ray_valid", rtl.ray_valid, model.ray_valid)) {
    ports.same("ray_data", rtl.ray_data, model.ray_data);
    ports.same("ray_last", rtl.ray_last, model.ray_last);
    ports.same("ray_place", rtl.ray_place, model.ray_place);
  }
}

void compare_intersections(Ports& ports, const ChipOutputs& rtl, const ChipOutputs& model, uint32_t kinds) {
  ports.of("intersection_pool");
  ports.same("put_ready", rtl.put_ready, model.put_ready);
  ports.same("request_ready", rtl.to_device.import_request_ready, model.to_device.import_request_ready);
  if (ports.both("beat_valid", rtl.to_device.import_beat_valid, model.to_device.import_beat_valid))
    ports.same("beat_data", rtl.to_device.import_beat, model.to_device.import_beat);
  if (ports.both("pixel_valid", rtl.pixel_valid, model.pixel_valid))
    ports.same("pixel_unit", rtl.pixel_unit, model.pixel_unit);
  for (uint32_t number = 1; number <= kinds; ++number) {
    const auto kind = static_cast<ImportKind>(number);
    ports.same("size", rtl.size[kind], model.size[kind]);
    ports.same("available", rtl.available[kind], model.available[kind]);
  }
}

void compare_memory(Ports& ports, const ChipOutputs& rtl, const ChipOutputs& model) {
  ports.of("memory_port");
  const UnitInputs &r = rtl.to_device, &m = model.to_device;
  ports.same("device_request_ready", r.memory_request_ready, m.memory_request_ready);
  if (ports.both("device_response_valid", r.memory_response_valid, m.memory_response_valid)) {
    ports.same("device_response_id", r.memory_response.id, m.memory_response.id);
    ports.same("device_response_beat", r.memory_response.beat, m.memory_response.beat);
    ports.same("device_response_data", r.memory_response.data, m.memory_response.data);
  }
  if (ports.both("memory_request_valid", rtl.memory_request_valid, model.memory_request_valid) &&
      ports.same("memory_request_traverser", rtl.memory_request.traverser, model.memory_request.traverser))
    compare_request(ports, rtl.memory_request.request, model.memory_request.request, false);
  ports.same("memory_beat_ready", rtl.memory_beat_ready, model.memory_beat_ready);
  ports.same("tree_request_ready", rtl.tree_request_ready, model.tree_request_ready);
  if (ports.both("tree_response_valid", rtl.tree_response_valid, model.tree_response_valid)) {
    ports.same("tree_response_beat", rtl.tree_response_beat, model.tree_response_beat);
    ports.same("tree_response_data", rtl.tree_response_data, model.tree_response_data);
  }
  ports.same("quiet", rtl.quiet, model.quiet);
}

void compare_frame(Ports& ports, const ChipOutputs& rtl, const ChipOutputs& model) {
  ports.of("frame_port");
  ports.same("unit_ready", rtl.to_device.frame_ready, model.to_device.frame_ready);
  ports.same("traverser_ready", rtl.contribution_ready, model.contribution_ready);
  if (ports.both("frame_valid", rtl.frame_valid, model.frame_valid)) {
    ports.same_word("frame_pixel", rtl.frame.pixel, model.frame.pixel);
    ports.same("frame_color", rtl.frame.rgb, model.frame.rgb);
  }
  if (ports.both("exported_valid", rtl.exported_valid, model.exported_valid)) {
    ports.same("exported_unit", rtl.exported_unit, model.exported_unit);
    ports.same_word("exported_pixel", rtl.exported_pixel, model.exported_pixel);
  }
}

void compare_traverser(Ports& ports, const ChipOutputs& rtl_chip, const ChipOutputs& model_chip) {
  const TraverserPorts &rtl = rtl_chip.traverser, &model = model_chip.traverser;
  const TreeFault &rtl_fault = rtl_chip.tree_fault, &model_fault = model_chip.tree_fault;
  ports.of("traverser");
  ports.same("ray_ready", rtl.ray_ready, model.ray_ready);
  if (ports.both("free_valid", rtl.free_valid, model.free_valid)) {
    ports.same("free_place", rtl.free_place, model.free_place);
    ports.same("free_shadow", rtl.free_shadow, model.free_shadow);
  }
  if (ports.both("put_valid", rtl.put_valid, model.put_valid)) {
    ports.same("put_kind", rtl.put_kind, model.put_kind);
    ports.same("put_data", rtl.put_data, model.put_data);
  }
  if (ports.both("contribution_valid", rtl.contribution_valid, model.contribution_valid)) {
    ports.same_word("contribution_pixel", rtl.contribution.pixel, model.contribution.pixel);
    ports.same("contribution_color", rtl.contribution.rgb, model.contribution.rgb);
  }
  if (ports.both("fault_valid", rtl_fault.valid, model_fault.valid)) {
    ports.same("fault_code", rtl_fault.code, model_fault.code);
    ports.same_word("fault_line", rtl_fault.line, model_fault.line);
  }
  if (rtl_chip.nodes_given != ChipOutputs::kNotSeen) {
    ports.same("node_given", rtl_chip.nodes_given, model_chip.nodes_given);
    ports.same("leaf_given", rtl_chip.leaves_given, model_chip.leaves_given);
  }
  if (!ports.both("request_valid", rtl.tree_request_valid, model.tree_request_valid)) return;
  const TreeRequest &r = rtl.tree_request, &m = model.tree_request;
  ports.same("request_second", r.second, m.second);
  ports.same_word("request_address", r.address, m.address);
  if (!ports.same("request_write", r.write, m.write) || !m.write) return;
  ports.same("request_data", r.data[0], m.data[0]);
  if (m.second) ports.same("request_data", r.data[1], m.data[1]);
}

}  // namespace

void compare_chip(const ChipOutputs& rtl, const ChipOutputs& model, uint32_t kinds) {
  Ports ports;
  compare_traverser(ports, rtl, model);
  compare_rays(ports, rtl, model);
  compare_intersections(ports, rtl, model, kinds);
  compare_controller(ports, rtl, model);
  compare_memory(ports, rtl, model);
  compare_frame(ports, rtl, model);
  compare_device(ports, rtl.device, model.device);
  ports.finish();
}

void compare_counts(const ChipCounts& rtl, const ChipCounts& model) {
  Ports ports;
  ports.of("ray_pool");
  ports.same("taken", rtl.rays_taken, model.rays_taken);
  ports.same("busy_cycles", rtl.ray_port_busy, model.ray_port_busy);
  ports.of("intersection_pool");
  ports.same("taken", rtl.packages_taken, model.packages_taken);
  ports.of("frame_port");
  ports.same("taken", rtl.contributions, model.contributions);
  ports.of("memory_port");
  ports.same("reads", rtl.memory_reads, model.memory_reads);
  ports.same("writes", rtl.memory_writes, model.memory_writes);
  ports.same("busy_cycles", rtl.memory_port_busy, model.memory_port_busy);
  ports.finish();
}

}  // namespace raypool::lockstep
