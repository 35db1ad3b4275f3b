// Reports lead to the place: RTL of which one signal inside, or one output, is altered is found out, and the
// report names the file that makes it.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <functional>
#include <utility>

#include "cosim/cosim.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "lockstep/rtl_loader.hpp"
#include "rtl/test_library.hpp"

namespace raypool {
namespace {

/// A signal below gen_unit[0].compute_unit, one bit of which is wrong from the `from`th cycle on in which it is not 0.
struct Tamper {
  const char* scope;
  const char* signal;
  const char* file;  ///< that a report must name first
  uint32_t from = 20;
};

/// RTL that shows the lockstep another value of one signal. Its outputs stay right: nothing but the inspection can
/// detect it.
class TamperedUnit : public ComputeUnit {
 public:
  TamperedUnit(std::unique_ptr<ComputeUnit> unit, const Tamper& tamper) : unit_(std::move(unit)), tamper_(tamper) {
    signal_ = unit_->signal(std::string("gen_unit[0].compute_unit") + tamper.scope, tamper.signal);
    EXPECT_NE(signal_.data, nullptr) << tamper.signal;
  }

  uint32_t units() const override { return unit_->units(); }
  void reset(uint32_t program_length, uint32_t memory_limit) override {
    unit_->reset(program_length, memory_limit);
    copy();
  }
  void set_argument(uint32_t index, uint32_t value) override {
    unit_->set_argument(index, value);
    copy();
  }
  const UnitOutputs& outputs() const override { return unit_->outputs(); }
  void clock(const UnitInputs& inputs) override {
    unit_->clock(inputs);
    copy();
  }
  void trace_on() override { unit_->trace_on(); }
  const UnitTrace& trace() const override { return unit_->trace(); }
  Signal signal(const std::string& scope, const std::string& name) const override {
    const Signal real = unit_->signal(scope, name);
    return real.data == signal_.data ? Signal{shown_.data(), real.bits} : real;
  }
  uint64_t counter(int number) override { return unit_->counter(number); }
  bool timed() const override { return true; }

 private:
  void copy() {
    const uint32_t bits = signal_.bits;
    const size_t bytes = bits <= 8 ? 1 : bits <= 16 ? 2 : bits <= 32 ? 4 : bits <= 64 ? 8 : (bits + 31) / 32 * 4;
    ASSERT_LE(bytes, sizeof(shown_));
    std::memcpy(shown_.data(), signal_.data, bytes);
    uint32_t low = 0;
    while (low < bits && (shown_[low / 8] >> low % 8 & 1) == 0) ++low;
    if (low < bits && ++seen_ > tamper_.from) shown_[low / 8] ^= static_cast<uint8_t>(1u << low % 8);
  }

  std::unique_ptr<ComputeUnit> unit_;
  Tamper tamper_;
  Signal signal_;
  alignas(8) std::array<uint8_t, 4096> shown_{};
  uint32_t seen_ = 0;
};

Configuration configuration() {
  Configuration configuration;
  configuration.name = "inspected";
  configuration.warps = 4;
  configuration.lanes = 2;
  configuration.data_cache_bytes = configuration.instruction_cache_bytes = 512;
  configuration.data_cache_mshrs = 2;
  return configuration;
}

class Inspected : public testing::TestWithParam<Tamper> {};

TEST_P(Inspected, NamesTheFileOfTheSignal) {
  const Tamper& tamper = GetParam();
  const std::string library = test::build_library(configuration());
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const RandomProgram program = make_random_program(configuration(), seed);
    Memory memory = program.memory;
    LockstepOptions options;
    options.inspect_until = kInspectAlways;
    const auto unit = make_lockstep_unit(
        configuration(), std::make_unique<TamperedUnit>(load_rtl_unit(library, configuration()), tamper), memory,
        options);
    ASSERT_EQ(unit->uninspected(), "");
    run_random_program(*unit, memory, program, seed);
    const std::vector<lockstep::Finding> findings = unit->inside();
    if (findings.empty()) continue;
    EXPECT_EQ(findings[0].files.substr(0, findings[0].files.find(',')), std::string("rtl/") + tamper.file)
        << findings[0].text;
    return;
  }
  FAIL() << "nothing was found in 60 programs";
}

// ALU instances stand by type, and there is one of each.
#define INT_INSTANCE ".gen_alu[3]"
#define PC_STACK ".gen_warp[0].warp.pc_stack"
#define MEM_ALU ".gen_alu[2].gen_mem.mem_alu"
#define RAY_ALU ".gen_alu[6].gen_ray.ray_alu"

// What each block gives to the others.
const Tamper kTampers[] = {
    {"", "waiting_launch", "compute/rp_launcher.v", 0},
    {"", "start", "compute/rp_launcher.v", 0},
    {"", "threads", "compute/rp_launcher.v", 0},
    {"", "active", "compute/rp_instruction_buffer.v"},
    {"", "fetch_pc", "compute/rp_instruction_buffer.v", 0},
    {PC_STACK, "top_q", "compute/rp_pc_stack.v", 0},
    {PC_STACK, "pc_o", "compute/rp_pc_stack.v"},
    {PC_STACK, "pc_valid_o", "compute/rp_pc_stack.v", 2},
    {"", "fetch_request", "compute/rp_instruction_buffer.v"},
    {"", "fetch_grant", "compute/rp_fetch_arbiter.v"},
    {"", "lookup_pc", "compute/rp_compute_unit.v"},
    {"", "instruction_hit", "compute/rp_instruction_cache.v"},
    {"", "instruction_miss", "compute/rp_instruction_cache.v", 2},
    {"", "fetched", "compute/rp_instruction_cache.v"},
    {"", "refill_done", "compute/rp_instruction_cache.v", 2},
    {"", "want", "compute/rp_instruction_buffer.v"},
    {"", "predicate_x", "compute/rp_predicate_file.v"},
    {"", "operand_a", "compute/rp_warp.v"},
    {"", "instance_grant", "compute/rp_dispatcher.v"},
    {INT_INSTANCE ".task_register", "task_valid_o", "compute/rp_task_register.v"},
    {INT_INSTANCE ".task_register", "task_operand_a_o", "compute/rp_task_register.v"},
    {"", "ready", "compute/rp_alu_pipeline.v"},
    {"", "done_valid", "compute/rp_alu_pipeline.v"},
    {"", "retire_data_o", "compute/rp_warp.v"},
    {"", "memory_request_address_o", "compute/rp_memory_arbiter.v", 2},
    {"", "export_data_o", "compute/rp_ray_export.v", 2},
    {MEM_ALU, "pass_q", "compute/rp_mem_alu.v"},
    {MEM_ALU, "quad_data", "compute/rp_data_cache.v"},
    {MEM_ALU, "allocates", "compute/rp_data_cache.v", 2},
    {MEM_ALU, "queue_count", "common/rp_request_queue.v", 2},
    {MEM_ALU ".u_cache", "found", "compute/rp_data_cache.v", 2},
    {MEM_ALU ".u_cache", "match", "compute/rp_miss_status.v", 0},
    {MEM_ALU ".u_cache.u_miss_status", "busy_q", "compute/rp_miss_status.v", 2},
    {MEM_ALU ".u_cache.u_miss_status", "waiters_q", "compute/rp_miss_status.v", 2},
    {MEM_ALU ".u_sequencer", "parked_q", "compute/rp_memory_sequencer.v", 2},
    {MEM_ALU ".u_sequencer", "next_valid_q", "compute/rp_memory_sequencer.v", 2},
    {RAY_ALU, "hold_q", "compute/rp_ray_alu.v", 0},
    {RAY_ALU, "parked_in_q", "compute/rp_ray_alu.v", 0},
    {RAY_ALU, "full", "compute/rp_ray_import.v", 2},
    {RAY_ALU, "import_data", "compute/rp_ray_import.v", 2},
    {RAY_ALU, "busy", "compute/rp_ray_export.v", 2},
};

INSTANTIATE_TEST_SUITE_P(Blocks, Inspected, testing::ValuesIn(kTampers),
                         [](const auto& tamper) { return std::string(tamper.param.signal); });

/// RTL of two units, one output of which is altered.
class AlteredUnit : public ComputeUnit {
 public:
  AlteredUnit(std::unique_ptr<ComputeUnit> unit, std::function<void(UnitOutputs&)> alter)
      : unit_(std::move(unit)), alter_(std::move(alter)) {
    show();
  }
  uint32_t units() const override { return unit_->units(); }
  void reset(uint32_t program_length, uint32_t memory_limit) override {
    unit_->reset(program_length, memory_limit);
    show();
  }
  void set_argument(uint32_t index, uint32_t value) override {
    unit_->set_argument(index, value);
    show();
  }
  const UnitOutputs& outputs() const override { return shown_; }
  void clock(const UnitInputs& inputs) override {
    unit_->clock(inputs);
    show();
  }
  void trace_on() override { unit_->trace_on(); }
  const UnitTrace& trace() const override { return unit_->trace(); }
  Signal signal(const std::string& scope, const std::string& name) const override { return unit_->signal(scope, name); }
  uint64_t counter(int number) override { return unit_->counter(number); }
  bool timed() const override { return true; }

 private:
  void show() {
    shown_ = unit_->outputs();
    alter_(shown_);
  }

  std::unique_ptr<ComputeUnit> unit_;
  std::function<void(UnitOutputs&)> alter_;
  UnitOutputs shown_;
};

struct Alteration {
  const char* name;
  std::function<void(UnitOutputs&)> alter;
  const char* look_at;
};

class InspectedArbiters : public testing::TestWithParam<Alteration> {};

TEST_P(InspectedArbiters, AreNamed) {
  const std::string library = test::build_library(configuration(), 2);
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const RandomProgram program = make_random_program(configuration(), seed, 120, 2);
    int runs = 0;
    const auto run = [&](uint64_t inspect_until) {
      ++runs;
      Memory memory = program.memory;
      LockstepOptions options;
      options.inspect_until = inspect_until;
      const auto unit = make_lockstep_unit(
          configuration(), std::make_unique<AlteredUnit>(load_rtl_unit(library, configuration(), 2), GetParam().alter),
          memory, options);
      run_random_program(*unit, memory, program, seed);
    };
    try {
      inspect_differences(run);
    } catch (const LockstepDifference& difference) {
      EXPECT_EQ(runs, 2);
      EXPECT_NE(std::string(difference.what()).find(std::string("look at: rtl/") + GetParam().look_at),
                std::string::npos)
          << difference.what();
      return;
    }
  }
  FAIL() << "nothing was found in 60 programs";
}

INSTANTIATE_TEST_SUITE_P(
    All, InspectedArbiters,
    testing::Values(
        Alteration{"launch", [](UnitOutputs& out) { out.launch_unit ^= 1; }, "compute/rp_block_scheduler.v"},
        Alteration{"memory", [](UnitOutputs& out) { out.memory_request.id ^= 32; }, "compute/rp_unit_memory_arbiter.v"},
        Alteration{"import", [](UnitOutputs& out) { out.import_request_unit ^= 1; }, "compute/rp_import_arbiter.v"},
        Alteration{"ray", [](UnitOutputs& out) { out.export_unit ^= 1; }, "compute/rp_port_arbiter.v"},
        Alteration{"frame", [](UnitOutputs& out) { out.frame_unit ^= 1; }, "compute/rp_port_arbiter.v"}),
    [](const auto& alteration) { return std::string(alteration.param.name); });

}  // namespace
}  // namespace raypool
