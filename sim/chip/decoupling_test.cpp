// Temporal decoupling changes nothing: a frame takes the same cycles when the device may never run ahead.
#include <gtest/gtest.h>

#include "chip/chip_module.hpp"
#include "chip/fixed_latency_memory.hpp"
#include "chip/simulation.hpp"
#include "chip/test_metronome.hpp"
#include "chip/test_real_frame.hpp"
#include "machine/cycle_unit.hpp"

namespace raypool::chip {
namespace {

/// Counts how often the device is asked to run.
class Counted : public ComputeUnit {
 public:
  explicit Counted(std::unique_ptr<ComputeUnit> device) : device_(std::move(device)) {}
  void reset(uint32_t program_length, uint32_t memory_limit) override { device_->reset(program_length, memory_limit); }
  void set_argument(uint32_t index, uint32_t value) override { device_->set_argument(index, value); }
  const UnitOutputs& outputs() const override { return device_->outputs(); }
  void clock(const UnitInputs& inputs) override { device_->clock(inputs); }
  uint64_t run(const UnitInputs& inputs, uint64_t cycles) override {
    ++runs;
    const uint64_t done = device_->run(inputs, cycles);
    clocked += done;
    return done;
  }
  const UnitTrace& trace() const override { return device_->trace(); }
  uint64_t counter(int number) override { return device_->counter(number); }
  bool timed() const override { return true; }

  uint64_t runs = 0, clocked = 0;

 private:
  std::unique_ptr<ComputeUnit> device_;
};

/// Looks at the device 5 cycles after each access is served.
struct LookingMemory : sc_core::sc_module {
  SC_HAS_PROCESS(LookingMemory);
  LookingMemory(const sc_core::sc_module_name& name, Memory& own_memory, const Counted& unit)
      : sc_module(name), memory(own_memory), device(unit) {
    socket.register_b_transport(this, &LookingMemory::b_transport);
    SC_METHOD(look);
    sensitive << later;
    dont_initialize();
  }
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    transfer(payload, memory);
    later.notify(delay + sc_core::sc_time(5, sc_core::SC_NS));
    delay += sc_core::sc_time(50, sc_core::SC_NS);
  }
  void look() { seen.push_back(device.clocked); }

  tlm_utils::simple_target_socket<LookingMemory, kMemoryBits> socket{"socket"};
  Memory& memory;
  const Counted& device;
  sc_core::sc_event later;
  std::vector<uint64_t> seen;  ///< cycles that the device had been clocked then
};

struct Drawn {
  Drawn(bool decoupled, const ChipConfiguration& around) : run(4, 4, 31, 17, 3) {
    run.options.configuration.chip = around;
    auto counted = std::make_unique<Counted>(std::make_unique<CycleUnit>(run.options.configuration, run.image.memory));
    unit = counted.get();
    run.set_device(std::move(counted));
    Simulation simulation;
    Chip chip("chip", run.options);
    LookingMemory memory("memory", run.image.memory, *unit);
    chip.memory.bind(memory.socket);
    std::unique_ptr<test::Metronome> metronome;
    if (!decoupled) metronome = std::make_unique<test::Metronome>("metronome");
    result = chip.draw();
    seen = memory.seen;
    if (!decoupled) {
      EXPECT_GE(metronome->beats, result.cycles);
    }
  }
  test::RealFrame run;
  Counted* unit;
  ChipResult result;
  std::vector<uint64_t> seen;  ///< by the memory
};

void expect_the_same_both_ways(const ChipConfiguration& around) {
  const Drawn ahead(true, around), stepped(false, around);
  EXPECT_LT(ahead.unit->runs, stepped.unit->runs / 2);   // it did run ahead,
  EXPECT_EQ(stepped.unit->runs, stepped.unit->clocked);  // and did not
  EXPECT_FALSE(ahead.seen.empty());
  EXPECT_EQ(ahead.seen, stepped.seen);
  EXPECT_EQ(ahead.unit->clocked, stepped.unit->clocked);
  const ChipResult &a = ahead.result, &b = stepped.result;
  EXPECT_TRUE(ahead.run.frame == stepped.run.frame);
  EXPECT_EQ(a.cycles, b.cycles);
  EXPECT_EQ(a.busy_cycles, b.busy_cycles);
  EXPECT_EQ(a.instructions, b.instructions);
  EXPECT_EQ(a.rays(), b.rays());
  EXPECT_EQ(a.traverser_stall_batches, b.traverser_stall_batches);
  EXPECT_EQ(a.resource_utilisation, b.resource_utilisation);
  EXPECT_EQ(a.rays_pool.mean, b.rays_pool.mean);
  EXPECT_EQ(a.normal_pool.mean, b.normal_pool.mean);
  EXPECT_EQ(a.shadow_pool.mean, b.shadow_pool.mean);
  EXPECT_EQ(a.ray_port_utilisation, b.ray_port_utilisation);
  EXPECT_EQ(a.memory_reads, b.memory_reads);
  for (size_t i = 0; i < a.alus.size(); ++i) EXPECT_EQ(a.alus[i].waiting, b.alus[i].waiting) << i;
}

TEST(TemporalDecoupling, ChangesNoCycleAndNoFigure) { expect_the_same_both_ways({}); }

TEST(TemporalDecoupling, ChangesNothingWithPipelinedPortsAndATraverserThatShades) {
  ChipConfiguration around;
  around.policy = PolicyName::Fill;
  around.shading = Shading::Traverser;
  around.ray_pool_pipelined = around.intersection_pool_pipelined = true;
  expect_the_same_both_ways(around);
}

TEST(TemporalDecoupling, ChangesNothingWithAControllerThatCounts) {
  ChipConfiguration around;
  around.controller = ControllerName::Counters;
  expect_the_same_both_ways(around);
  around.policy = PolicyName::Fill;
  around.shading = Shading::Traverser;
  around.ray_pool_pipelined = around.intersection_pool_pipelined = true;
  expect_the_same_both_ways(around);
}

}  // namespace
}  // namespace raypool::chip
