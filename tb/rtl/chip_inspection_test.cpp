// Reports of a chip lead to the place: of a traverser of which one signal inside is altered the file is named that
// makes it, and in RTL that is right nothing is found.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lockstep/lockstep_chip.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "lockstep/rtl_loader.hpp"
#include "rtl/chip_frames.hpp"
#include "rtl/traverser_frames.hpp"

namespace raypool {
namespace {

using namespace test;

constexpr const char* kTraverser = "gen_inside.traverser";
constexpr const char* kLane = "gen_inside.traverser.gen_lane[0].lane";

/// A signal of an instance inside the chip, the lowest bit of which that is set is shown as 0 from the `from`th cycle
/// on in which it has one.
struct Tamper {
  const char* scope;
  const char* signal;
  const char* file;  ///< that must be named first
  uint32_t from = 5;
};

/// RTL that shows the lockstep another value of one signal. Its ports stay right: nothing but the inspection can detect
/// it.
class TamperedChip : public ChipDevice {
 public:
  TamperedChip(std::unique_ptr<ChipDevice> chip, const Tamper& tamper) : chip_(std::move(chip)), tamper_(tamper) {
    signal_ = chip_->signal(tamper.scope, tamper.signal);
    EXPECT_NE(signal_.data, nullptr) << tamper.signal;
  }
  uint32_t units() const override { return chip_->units(); }
  void start(const FrameSetup& setup) override {
    chip_->start(setup);
    copy();
  }
  void start_next(const FrameSetup& setup) override {
    chip_->start_next(setup);
    copy();
  }
  const ChipOutputs& outputs() const override { return chip_->outputs(); }
  void clock(const ChipInputs& inputs) override {
    chip_->clock(inputs);
    copy();
  }
  void settle(const ChipInputs& inputs) override {
    chip_->settle(inputs);
    show();
  }
  ChipCounts counts() override { return chip_->counts(); }
  uint64_t counter(int number) override { return chip_->counter(number); }
  Signal signal(const std::string& scope, const std::string& name) const override {
    const Signal real = chip_->signal(scope, name);
    return real.data == signal_.data ? Signal{shown_.data(), real.bits} : real;
  }

 private:
  void copy() {
    seen_ += show() ? 1 : 0;
    show();
  }
  // True if it has a bit that is set.
  bool show() {
    const uint32_t bits = signal_.bits;
    const size_t bytes = bits <= 8 ? 1 : bits <= 16 ? 2 : bits <= 32 ? 4 : bits <= 64 ? 8 : (bits + 31) / 32 * 4;
    EXPECT_LE(bytes, sizeof(shown_));
    std::memcpy(shown_.data(), signal_.data, bytes);
    uint32_t low = 0;
    while (low < bits && (shown_[low / 8] >> low % 8 & 1) == 0) ++low;
    if (low < bits && seen_ > tamper_.from) shown_[low / 8] ^= static_cast<uint8_t>(1u << low % 8);
    return low < bits;
  }

  std::unique_ptr<ChipDevice> chip_;
  Tamper tamper_;
  Signal signal_;
  alignas(8) std::array<uint8_t, 4096> shown_{};
  uint32_t seen_ = 0;
};

class InspectedChip : public testing::TestWithParam<Tamper> {};

TEST_P(InspectedChip, NamesTheFileOfTheSignal) {
  const Machine machine = smallest_inside();
  const Configuration& c = machine.configuration;
  Drawing drawing(machine, {9, 11, 3, true}, make_cornell());
  const auto chip = make_lockstep_chip(
      c, std::make_unique<TamperedChip>(load_rtl_chip(chip_library(machine), c, machine.units), GetParam()),
      drawing.memory(), c.name, kInspectAlways);
  drawing.draw_until(*chip, [&] { return !chip->inside().empty(); });
  const std::vector<lockstep::Finding> inside = chip->inside();
  ASSERT_FALSE(inside.empty());
  const std::string& files = inside[0].files;
  EXPECT_EQ(files.substr(0, files.find(',')), std::string("rtl/") + GetParam().file) << inside[0].text;
}

const Tamper kTampers[] = {
    {kTraverser, "set_valid", "traverser/rp_ray_setup.v"},
    {kTraverser, "padding", "traverser/rp_ray_padding.v", 0},
    {kTraverser, "reciprocal", "traverser/rp_ray_direction.v", 0},
    {kTraverser, "limit_key", "traverser/rp_ray_setup.v", 0},
    {kTraverser, "slot_valid", "common/rp_free_list.v"},
    {kLane, "given_q", "traverser/rp_traverser_lane.v"},
    {kLane, "met", "traverser/rp_box_axis.v"},
    {kLane, "entry", "traverser/rp_box_axis.v", 0},
    {kLane, "children", "traverser/rp_child_order.v", 0},
    {kLane, "next_valid", "traverser/rp_lane_stacks.v", 2},
    {kLane, "done", "traverser/rp_lane_stacks.v", 2},
    {kLane, "leaf_valid", "traverser/rp_lane_hits.v", 2},
    {kTraverser, "node_want", "traverser/rp_traverser_lane.v"},
    {kTraverser, "leaf_want", "traverser/rp_leaf_reader.v", 0},
    {kTraverser, "test_valid", "traverser/rp_leaf_reader.v"},
    {kTraverser, "stack_request_valid", "traverser/rp_lane_stacks.v", 0},
    {kTraverser, "result_hit", "traverser/rp_triangle_pipe.v", 0},
    {kTraverser, "result_valid", "traverser/rp_triangle_group.v"},
    {kTraverser, "node_given", "traverser/rp_tree_banks.v"},
    {kTraverser, "node_given_data", "traverser/rp_tree_cache.v", 0},
    {kTraverser, "leaf_given_data", "traverser/rp_tree_cache.v", 0},
    {kTraverser, "node_request_valid", "traverser/rp_tree_banks.v", 0},
    {kTraverser, "fill_data", "traverser/rp_tree_port.v", 0},
    {kTraverser, "slot_free", "traverser/rp_ray_exit.v", 0},
    {"controller.gen_unit[0].launch_records", "normal_o", "chip/rp_launch_records.v", 0},
    {"controller.tile_walk", "tile_block_o", "chip/rp_tile_walk.v", 0},
    {"controller.launch_rules", "secondary_room_o", "chip/rp_launch_rules.v", 0},
    {"controller.gen_thesis.policy", "kind_o", "chip/rp_thesis_policy.v", 2},
    {"memory_port.device_requests", "data_o", "common/rp_ram_queue.v", 0},
    {"ray_pool.free_list", "valid_o", "common/rp_free_list.v", 0},
};

INSTANTIATE_TEST_SUITE_P(Blocks, InspectedChip, testing::ValuesIn(kTampers),
                         [](const auto& tamper) { return std::string(tamper.param.signal); });

TEST(InspectedChip, HasNothingInsideWhereItIsRight) {
  const Machine machine = smallest_inside();
  const Configuration& c = machine.configuration;
  for (const uint32_t tree : {0u, 1u, 2u}) {
    Drawing drawing(machine, {5, 7, 3, true}, random_scene(tree + 1, 60), tree);
    const auto chip = make_lockstep_chip(c, load_rtl_chip(chip_library(machine), c, machine.units), drawing.memory(),
                                         c.name, kInspectAlways);
    drawing.draw_on(*chip);
    EXPECT_TRUE(chip->inside().empty()) << chip->inside()[0].text;
  }
}

}  // namespace
}  // namespace raypool
