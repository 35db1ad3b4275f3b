// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Several compute units behind one set of ports: rtl/compute/rp_multiprocessor.v in C++, around units of any engine.
#pragma once

#include <memory>
#include <vector>

#include "bits.hpp"
#include "machine/compute/block_scheduler.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/import_arbiter.hpp"
#include "machine/compute/port_arbiter.hpp"
#include "machine/compute/unit_memory_arbiter.hpp"

namespace raypool {

/// Block scheduler and arbiters agree with the RTL in every cycle (docs/machine/multiprocessor.md); so the whole agrees
/// as far as its units do. A clock costs a clock of each unit and some tests; payloads are copied only while they are
/// valid.
class Multiprocessor : public ComputeUnit {
 public:
  /// 2 to kMostUnits single units of one configuration, with intersections of so many beats.
  Multiprocessor(std::vector<std::unique_ptr<ComputeUnit>> units, int intersection_beats);

  uint32_t units() const override { return size32(units_); }

  void reset(uint32_t program_length, uint32_t memory_limit) override;
  void set_argument(uint32_t index, uint32_t value) override;
  const UnitOutputs& outputs() const override { return outputs_; }
  void clock(const UnitInputs& inputs) override;
  uint64_t run(const UnitInputs& inputs, uint64_t cycles) override;
  void trace_on() override;
  void trace_off() override;
  const UnitTrace& trace() const override { return trace_; }
  uint64_t counter(int number) override;
  bool timed() const override;
  std::vector<Fault> faults() const override { return faults_; }

 private:
  void give(const UnitInputs& inputs);
  void present();
  void gather_trace();
  void gather_faults();

  std::vector<std::unique_ptr<ComputeUnit>> units_;
  std::vector<UnitInputs> inputs_;  // [unit]
  UnitOutputs outputs_;
  std::vector<Fault> faults_;
  BlockScheduler block_scheduler_;
  UnitMemoryArbiter memory_arbiter_;
  PortArbiter export_arbiter_, frame_arbiter_, fault_arbiter_;
  int intersection_beats_;
  ImportArbiter import_arbiter_;
  bool tracing_ = false;
  UnitTrace trace_;
  std::vector<std::vector<uint32_t>> spare_;  // lanes of past events, so that a traced cycle allocates nothing
};

/// One device of 1, 2 or 4 units of one configuration, with intersections of so many beats: a single one is returned as
/// it is. Throws InputError for other numbers.
std::unique_ptr<ComputeUnit> make_multiprocessor(std::vector<std::unique_ptr<ComputeUnit>> units,
                                                 int intersection_beats = kIntersectionBeats);

}  // namespace raypool
