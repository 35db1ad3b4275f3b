#include "lockstep/inspection.hpp"

#include <fmt/format.h>

#include <utility>

namespace raypool::lockstep {
namespace {

/// What stands at the device's memory port is what the unit shows, but for the unit's number in the id.
bool same_request(const MemoryRequest& shown, const UnitWires& unit) {
  if (shown.write != (unit.memory_request_write_o.value() != 0) ||
      shown.address != unit.memory_request_address_o.value())
    return false;
  if (!shown.write) return (shown.id & 31) == unit.memory_request_id_o.value();
  if (shown.mask != unit.memory_request_mask_o.value()) return false;
  for (uint32_t i = 0; i < kBeatWords; ++i)
    if ((shown.mask >> i & 1) != 0 && shown.data[i] != unit.memory_request_data_o.word(i)) return false;
  return true;
}

}  // namespace

Inspection::Inspection(const Configuration& configuration, const ComputeUnit& rtl,
                       const std::vector<CycleUnit*>& models)
    : rtl_(&rtl), models_(&models), intersection_beats_(static_cast<int>(configuration.intersection_beats())) {
  units_.reserve(models.size());
  for (uint32_t u = 0; u < models.size(); ++u) units_.emplace_back(configuration, rtl, *models[u], u);
}

void Inspection::reset(uint32_t program_length) {
  for (UnitInspection& unit : units_) unit.reset(program_length);
  findings_.clear();
  block_scheduler_ = {};
  memory_ = {};
  exports_ = frames_ = {};
  imports_ = ImportArbiter(intersection_beats_);
  before_ = {};
}

void Inspection::argument_written() {
  for (UnitInspection& unit : units_) unit.argument_written();
}

void Inspection::advance(const UnitInputs& inputs) {
  if (!active()) return;
  const UnitOutputs& out = rtl_->outputs();
  const bool several = units_.size() > 1;
  if (several) check_arbiters();  // the first cycle after a reset has not been
  for (uint32_t u = 0; u < units_.size(); ++u) {
    UnitTransfers given;
    given.launch = inputs.launch_valid && out.launch_ready && (!several || out.launch_unit == u);
    if (given.launch) given.command = inputs.launch;
    given.request_ready = inputs.memory_request_ready && (!several || unit_of_id(out.memory_request.id) == u);
    given.response = inputs.memory_response_valid && (!several || unit_of_id(inputs.memory_response.id) == u);
    given.response_id = inputs.memory_response.id & 31;
    given.response_beat = inputs.memory_response.beat;
    given.import_beat = inputs.import_beat_valid && (!several || (imports_.expects() && imports_.receiver() == u));
    if (given.import_beat) given.beat = inputs.import_beat;
    units_[u].advance(given);
  }
  if (several) {
    block_scheduler_.clock(inputs.launch_valid);
    memory_.clock(inputs.memory_request_ready);
    imports_.clock(inputs.import_request_ready, inputs.import_beat_valid);
    exports_.clock(inputs.export_ready, out.export_last);
    frames_.clock(inputs.frame_ready);
  }
  before_ = inputs;
}

void Inspection::check() {
  if (!active()) return;
  if (units_.size() > 1) check_arbiters();
  for (uint32_t u = 0; u < units_.size(); ++u) {
    // The ports' arbiters choose the unit that gets a response; a unit that gets another's would be blamed for what it
    // does with it.
    const bool response = before_.memory_response_valid && unit_of_id(before_.memory_response.id) == u;
    if (units_.size() > 1 && (units_[u].wires().memory_response_valid_i.value() != 0) != response)
      find("rtl/compute/rp_unit_memory_arbiter.v, rtl/compute/rp_multiprocessor.v",
           "a response goes to another unit than its id names");
    units_[u].check();
  }
}

void Inspection::find(const char* files, const char* text) {
  if (findings_.empty()) findings_.push_back({(*models_)[0]->now(), files, text});
}

// The units that are chosen in this cycle, given what the RTL's units ask for.
void Inspection::check_arbiters() {
  uint32_t ready = 0, busy = 0, requests = 0, imports = 0, exports = 0, frames = 0;
  for (uint32_t u = 0; u < units_.size(); ++u) {
    const UnitWires& w = units_[u].wires();
    ready |= w.launch_ready_o.value() << u;
    busy |= w.busy_o.value() << u;
    requests |= w.memory_request_valid_o.value() << u;
    imports |= w.import_request_valid_o.value() << u;
    exports |= w.export_valid_o.value() << u;
    frames |= w.frame_valid_o.value() << u;
  }
  block_scheduler_.present(ready, busy);
  memory_.present(requests);
  imports_.present(imports);
  exports_.present(exports);
  frames_.present(frames);
  const UnitOutputs& out = rtl_->outputs();
  if (out.launch_ready != block_scheduler_.ready() || (out.launch_ready && out.launch_unit != block_scheduler_.unit()))
    find("rtl/compute/rp_block_scheduler.v, rtl/common/rp_round_robin.v",
         "the launch is offered to another unit than its rule chooses");
  if (out.memory_request_valid != memory_.valid() ||
      (out.memory_request_valid && unit_of_id(out.memory_request.id) != memory_.choice()))
    find("rtl/compute/rp_unit_memory_arbiter.v, rtl/compute/rp_port_arbiter.v, rtl/common/rp_round_robin.v",
         "another unit's memory request is taken than its rule chooses");
  else if (out.memory_request_valid && !same_request(out.memory_request, units_[memory_.choice()].wires()))
    find("rtl/compute/rp_unit_memory_arbiter.v, rtl/compute/rp_multiprocessor.v",
         "the memory request is not that of its unit");
  if (out.import_request_valid != imports_.valid() ||
      (out.import_request_valid && out.import_request_unit != imports_.choice()))
    find("rtl/compute/rp_import_arbiter.v, rtl/compute/rp_port_arbiter.v, rtl/common/rp_request_queue.v",
         "another unit's import request is taken than its rule chooses");
  if (out.export_valid != exports_.valid() || (out.export_valid && out.export_unit != exports_.choice()))
    find("rtl/compute/rp_port_arbiter.v, rtl/compute/rp_multiprocessor.v, rtl/common/rp_round_robin.v",
         "another unit's ray is exported than its rule chooses");
  if (out.frame_valid != frames_.valid() || (out.frame_valid && out.frame_unit != frames_.choice()))
    find("rtl/compute/rp_port_arbiter.v, rtl/common/rp_round_robin.v, rtl/compute/rp_multiprocessor.v",
         "another unit's contribution is sent than its rule chooses");
}

std::vector<Finding> Inspection::findings() const {
  std::vector<Finding> all = findings_;
  for (uint32_t u = 0; u < units_.size(); ++u) {
    for (Finding finding : units_[u].findings()) {
      if (!all.empty() && finding.cycle > all.front().cycle) continue;
      if (!all.empty() && finding.cycle < all.front().cycle) all.clear();
      if (units_.size() > 1) finding.text = fmt::format("unit {}: ", u) + finding.text;
      all.push_back(std::move(finding));
    }
  }
  return all;
}

}  // namespace raypool::lockstep
