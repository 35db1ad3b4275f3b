// The ray ALU with its import and export engines: register by register as the model has
// them, and the packages that come and go.
#include <fmt/format.h>

#include "bits.hpp"
#include "lockstep/inspection.hpp"

namespace raypool::lockstep {
namespace {

constexpr const char* kAlu = "rtl/compute/rp_ray_alu.v";
constexpr const char* kImport =
    "rtl/compute/rp_ray_import.v, rtl/compute/rp_ray_alu.v, rtl/compute/rp_import_arbiter.v";
constexpr const char* kExport = "rtl/compute/rp_ray_export.v, rtl/compute/rp_ray_alu.v, rtl/compute/rp_port_arbiter.v";

}  // namespace

void UnitInspection::check_ray_alu() {
  const RayAlu& ray = model_->ray();
  const uint32_t instance = first_instance(configuration_, AluType::Ray);
  // What is idle on both sides needs no closer look.
  if (!ray.active() && !ray.moves_rays() && parked_ == 0 && model_->ray_task() < 0 &&
      (w_.ready.value() >> instance & 1) != 0 &&
      (ray_.hold_q.value() | ray_.busy.value() | w_.import_active.value() | w_.export_valid_o.value() |
       w_.ray_fault.value()) == 0)
    return;
  const RayAlu::Registers& r = ray.registers();
  expect(w_.ray_fault.value(), ray.fault(), kAlu, "ray ALU, fault");
  expect(ray_.hold_q.value(), r.hold, kAlu, "ray ALU, steps are left");
  if (r.hold) expect(ray_.step_q.value(), r.step, kAlu, "ray ALU, step");
  expect(ray_.parked_in_q.value(), r.parked_in, kAlu, "ray ALU, warps with a rin that waits");
  expect(ray_.parked_out_q.value(), r.parked_out, kAlu, "ray ALU, warps with a rout or rfb that waits");
  // Roles change by swaps alone.
  const uint32_t swapping = parked_ | r.parked_in | r.parked_out;
  parked_ = r.parked_in | r.parked_out;
  for (uint32_t warps = swapping; warps != 0; warps &= warps - 1) {
    const uint32_t warp = lowest(warps);
    const RayAlu::Roles& roles = ray.roles(warp);
    expect(
        ray_.input_q.bits(warp * 2, 2) | ray_.current_q.bits(warp * 2, 2) << 4 | ray_.output_q.bits(warp * 2, 2) << 8,
        roles.input | uint32_t{roles.current} << 4 | uint32_t{roles.output} << 8, kAlu,
        "ray ALU, roles of a warp's slices");
  }
  expect(w_.ready.flag(instance), ray.ready(model_->ray_task()), kAlu, "ray ALU, ready");
  expect(w_.done_valid.flag(instance), ray.done() != 0, kAlu, "ray ALU, done");
  if (ray.done() != 0)
    expect(warp_field(w_.done_warp, instance), lowest(ray.done()), kAlu, "ray ALU, warp that is done");
  check_import();
  check_ray_ports();
}

void UnitInspection::check_import() {
  const RayAlu& ray = model_->ray();
  const RayImport::Registers& r = ray.import().registers();
  expect(w_.import_active.value(), r.active, kImport, "import, packages are left");
  expect(w_.import_request_valid_o.value(), r.request_valid, kImport, "import, request");
  expect(ray_.full.value(), r.full, kImport, "import, slices with all their packages");
  expect(ray_.import_write.value(), r.write, kImport, "import, a beat is written");
  if (!before_.import_beat) return;
  expect(ray_.import_set.value(), r.write_set, kImport, "import, set");
  expect(ray_.import_thread.value(), r.write_thread, kImport, "import, thread");
  expect(ray_.import_word.value(), r.write_word, kImport, "import, word");
  expect(ray_.import_mask.value(), (1u << r.write_words) - 1, kImport, "import, words that are written");
  // The beat that came is behind the one that waited for it.
  const uint32_t waited = (r.write_words - 1) / kBeatWords * kBeatWords;
  for (uint32_t word = waited; word < r.write_words; ++word)
    expect(ray_.import_data.word(word), before_.beat[word - waited], kImport, "import, data");
}

void UnitInspection::check_ray_ports() {
  const RayAlu& ray = model_->ray();
  const UnitOutputs& out = model_->outputs();
  expect(ray_.busy.value(), ray.exports().registers().busy, kExport, "export, slices that wait or are read");
  expect(w_.export_valid_o.value(), out.export_valid, kExport, "export, a beat of a ray");
  expect(w_.frame_valid_o.value(), out.frame_valid, kExport, "export, a contribution");
  bool same = true;
  if (out.export_valid) {
    expect(w_.export_last_o.value(), out.export_last, kExport, "export, last beat");
    for (uint32_t i = 0; i < kBeatWords; ++i) same = same && w_.export_data_o.word(i) == out.export_data[i];
  } else if (out.frame_valid) {
    same = w_.frame_pixel_o.value() == out.frame.pixel;
    for (uint32_t i = 0; i < 3; ++i) same = same && w_.frame_color_o.word(i) == out.frame.rgb[i];
  }
  if (!same)
    find("rtl/compute/rp_ray_export.v, rtl/compute/rp_ray_memory.v, rtl/compute/rp_ray_alu.v",
         "export: other words than the slice holds");
}

}  // namespace raypool::lockstep
