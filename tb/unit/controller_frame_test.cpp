// The controller in Verilog beside that of the SystemC chip while this one draws frames: what happens on the chip is
// shown to both, and each launch must be the other one's, in its cycle, to the end of the frame.
#include <gtest/gtest.h>
#include <verilated.h>

#include <memory>
#include <utility>

#include "chip/chip_clock.hpp"
#include "chip/chip_module.hpp"
#include "chip/fixed_latency_memory.hpp"
#include "chip/intersection_pool.hpp"
#include "chip/ray_pool.hpp"
#include "chip/simulation.hpp"
#include "chip/test_frame_run.hpp"
#include "unit/clocked.hpp"
#include "unit/controller_machines.hpp"

namespace raypool::bench {
namespace {

/// A device whose ports are seen: as they were in its last cycle.
class SeenDevice : public ComputeUnit {
 public:
  explicit SeenDevice(ComputeUnit& device) : device_(device) {}
  uint32_t units() const override { return device_.units(); }
  void reset(uint32_t program_length, uint32_t memory_limit) override { device_.reset(program_length, memory_limit); }
  void set_argument(uint32_t index, uint32_t value) override { device_.set_argument(index, value); }
  const UnitOutputs& outputs() const override { return device_.outputs(); }
  void clock(const UnitInputs& now) override {
    inputs = now;
    before = device_.outputs();
    ++cycles;
    device_.clock(now);
  }
  const UnitTrace& trace() const override { return device_.trace(); }
  uint64_t counter(int number) override { return device_.counter(number); }
  bool timed() const override { return true; }

  UnitInputs inputs;
  UnitOutputs before;
  uint64_t cycles = 0;

 private:
  ComputeUnit& device_;
};

/// Looks at the chip at the end of each cycle.
template <typename M>
class Beside : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(Beside);
  Beside(const sc_core::sc_module_name& name, SeenDevice& device, const ChipOptions& options)
      : sc_module(name),
        device_(device),
        clock_(dynamic_cast<chip::TimeIf&>(*sc_core::sc_find_object("chip.clock"))),
        rays_(dynamic_cast<chip::RayPool&>(*sc_core::sc_find_object("chip.ray_pool"))),
        intersections_(dynamic_cast<chip::IntersectionPool&>(*sc_core::sc_find_object("chip.intersection_pool"))),
        bench_(1) {
    u_.start_i = 1;
    u_.width_i = options.width;
    u_.height_i = options.height;
    u_.reflections_i = options.depth > 1 && options.reflections;
    u_.eye_pc_i = options.entries[RayKernel::CastEye];
    u_.secondary_pc_i = options.entries[RayKernel::CastSecondary];
    u_.direct_pc_i = options.entries[RayKernel::CastSecondaryDirect];
    u_.shade_pc_i = options.entries[RayKernel::Shade];
    SC_METHOD(look);
    sensitive << look_;
  }

  bool busy() const { return u_.busy_o != 0; }
  uint64_t launches = 0, cycles = 0, differences = 0;

 private:
  // Levels on the ports are those at the end of the cycle before, and so is what has left a unit.
  void look() {
    clock_.notify(look_, chip::Phase::Monitor, 1);
    const bool clocked = device_.cycles != clocked_;
    clocked_ = device_.cycles;
    const UnitOutputs& seen = clocked ? device_.before : device_.outputs();
    u_.launch_ready_i = seen.launch_ready;
    u_.launch_unit_i = seen.launch_unit;
    u_.kernel_done_i = clocked ? seen.kernel_done : 0;
    set(u_.exports_i, exports_port<M>([&](uint32_t unit) { return seen.exports[unit]; }));
    u_.eval();
    compare(clocked && device_.inputs.launch_valid ? &device_.inputs.launch : nullptr);
    bench_.clock();
    ++cycles;

    u_.start_i = 0;
    u_.rays_i = rays_.size();
    u_.shadow_rays_i = rays_.shadow_rays();
    Controller::Levels levels;
    for (const ImportKind kind : {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct}) {
      levels.size[kind] = intersections_.size(kind);
      levels.available[kind] = intersections_.available(kind);
    }
    show_intersections<M>(u_, levels);
    u_.outcome_valid_i = clocked && seen.export_valid && device_.inputs.export_ready && seen.export_last;
    u_.outcome_unit_i = seen.export_unit;
    u_.outcome_shadow_i = (seen.export_data[3] & kShadowFlag) != 0;  // the last beat ends with the flags
    u_.exported_valid_i = clocked && seen.frame_valid && device_.inputs.frame_ready;
    u_.exported_unit_i = seen.frame_unit;
  }

  void compare(const LaunchCommand* launch) {
    if (differences != 0) return;
    const uint64_t cycle = clock_.cycle();
    const auto expect = [&](uint64_t verilog, uint64_t systemc, const char* what) {
      EXPECT_EQ(verilog, systemc) << what << ", cycle " << cycle;
      differences += verilog != systemc;
    };
    expect(u_.busy_o, cycle != 0, "busy");
    expect(u_.launch_valid_o, launch != nullptr, "launch_valid");
    if (launch == nullptr || differences != 0) return;
    ++launches;
    expect(u_.launch_pc_o, launch->pc, "launch_pc");
    expect(u_.launch_threads_o, launch->threads, "launch_threads");
    expect(u_.launch_import_o, static_cast<uint64_t>(launch->import), "launch_import");
    if (launch->import == ImportKind::None) expect(u_.launch_block_o, launch->block, "launch_block");
  }

  SeenDevice& device_;
  chip::TimeIf& clock_;
  chip::RayPool& rays_;
  chip::IntersectionPool& intersections_;
  Clocked<typename M::Unit> bench_;
  typename M::Unit& u_ = *bench_.u;
  uint64_t clocked_ = 0;
  sc_core::sc_event look_;
};

template <typename M>
class ControllerBesideTheChips : public testing::Test {};
TYPED_TEST_SUITE(ControllerBesideTheChips, Machines);

TYPED_TEST(ControllerBesideTheChips, LaunchesTheSameInTheSameCycles) {
  using M = TypeParam;
  uint64_t launches = 0;
  for (uint32_t frame = 0; frame < 12; ++frame) {
    const uint32_t width = frame == 0 ? 67 : 1 + frame * 7 % 30, height = frame == 0 ? 41 : 1 + frame * 11 % 23;
    SCOPED_TRACE(testing::Message() << "frame " << frame << ", " << width << " x " << height);
    const uint32_t lanes = std::min(M::kContents, 8u);
    test::FrameRun run(M::kContents / lanes, lanes, M::kUnits, width, height, 1 + frame % 4, 1 << frame % 8, frame);
    run.world.shadows = 8 + static_cast<int>(frame % 9);
    run.options.configuration.chip = M::chip();
    run.options.configuration.chip.controller = ControllerName::Counters;
    const bool modelled = M::walk_order() == TileOrder::Hilbert;
    run.options.configuration.chip.traverser = modelled ? TraverserName::Modelled : TraverserName::Static;
    run.options.configuration.chip.modelled_traverser_tile_order = M::walk_order();
    for (test::ScriptedUnit* unit : run.units) unit->set_world(run.world);
    test::WorldTracer tracer(run.world);
    SeenDevice device(*run.device);
    run.options.device = &device;
    run.options.tracer = &tracer;
    run.options.frame = &run.frame;

    chip::Simulation simulation;
    chip::Chip chip("chip", run.options);
    chip::FixedLatencyMemory memory("memory", run.memory, run.options.configuration.chip.memory_latency);
    chip.memory.bind(memory.socket);
    Beside<M> beside("beside", device, run.options);
    const ChipResult result = chip.draw();
    run.expect_conserved(result);
    EXPECT_EQ(beside.differences, 0u);
    EXPECT_GE(beside.cycles, result.cycles);
    launches += beside.launches;
  }
  EXPECT_GT(launches, 200u);
}

}  // namespace
}  // namespace raypool::bench
