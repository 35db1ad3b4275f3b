#include "machine/compute/multiprocessor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "bits.hpp"
#include "machine/compute/functional_unit.hpp"
#include "machine/compute/test_chip.hpp"
#include "machine/compute/test_program.hpp"

namespace raypool {
namespace {

using test::assembled;
using test::TestChip;

constexpr uint32_t kMemoryBytes = 65536;

Configuration configuration() {
  Configuration result;
  result.warps = 2;
  result.lanes = 4;
  return result;
}

struct Fixture {
  Memory memory{kMemoryBytes};
  std::unique_ptr<ComputeUnit> device;
  TestChip chip;

  Fixture(size_t units, const std::vector<uint64_t>& code, int ready_percent = 100)
      : device(make(units, memory)), chip(*device, memory, 1, ready_percent) {
    test::put_program(memory, code);
    device->reset(size32(code), kMemoryBytes);
  }
  static std::unique_ptr<ComputeUnit> make(size_t count, Memory& memory) {
    std::vector<std::unique_ptr<ComputeUnit>> units;
    for (size_t i = 0; i < count; ++i) units.push_back(make_functional_unit(configuration(), memory));
    return make_multiprocessor(std::move(units));
  }
  void launch(uint32_t threads, uint32_t block, ImportKind import = ImportKind::None) {
    LaunchCommand command;
    command.threads = threads;
    command.block = block;
    command.import = import;
    chip.launches.push_back(command);
  }
};

// memory[1024 + 64 * block + 4 * thread] = block + thread
const std::vector<uint64_t> kStoreProgram = assembled(R"(
    tid r1
    block r2
    iadd r3, r1, r2
    shl r4, r2, 6
    shl r5, r1, 2
    iadd r4, r4, r5
    st [r4+1024], r3
    exit)");
const std::vector<uint64_t> kEndlessProgram = assembled("@p1 jnone 0; exit");
// Every package becomes a ray and a contribution.
const std::vector<uint64_t> kRayProgram = assembled(R"(
    rin
    rld r1, 7
    rst 7, r1
    rout
    rst 7, r1
    rfb
    exit)");

TEST(Multiprocessor, IsOneTwoOrFourUnits) {
  Memory memory(kMemoryBytes);
  EXPECT_THROW(Fixture::make(0, memory), InputError);
  EXPECT_THROW(Fixture::make(3, memory), InputError);
  EXPECT_THROW(Fixture::make(5, memory), InputError);
  for (const size_t units : {1u, 2u, 4u}) EXPECT_EQ(Fixture::make(units, memory)->units(), units);
  EXPECT_EQ(dynamic_cast<Multiprocessor*>(Fixture::make(1, memory).get()), nullptr) << "a single unit is wrapped";
}

TEST(Multiprocessor, RunsEveryBlockOnceWhateverThePortsDo) {
  for (const size_t units : {2u, 4u}) {
    Fixture fixture(units, kStoreProgram, 60);
    for (uint32_t block = 0; block < 50; ++block) fixture.launch(8, block);
    EXPECT_TRUE(fixture.chip.run());
    EXPECT_EQ(fixture.chip.kernels_done, 50u);
    for (uint32_t block = 0; block < 50; ++block) {
      for (uint32_t t = 0; t < 8; ++t) EXPECT_EQ(fixture.memory.load(1024 + 64 * block + 4 * t), block + t);
    }
    EXPECT_EQ(fixture.device->counter(counter::kInstructions), 50u * 2 * 8);
    EXPECT_EQ(fixture.device->outputs().unit_idle, (1u << units) - 1);
  }
}

TEST(Multiprocessor, GivesEveryUnitAKernelBeforeASecondWaitsAnywhere) {
  Fixture fixture(4, kEndlessProgram);
  const UnitOutputs& out = fixture.device->outputs();
  for (uint32_t i = 0; i < 8; ++i) {
    ASSERT_TRUE(out.launch_ready);
    EXPECT_EQ(out.launch_unit, i % 4);
    fixture.launch(8, i);
    fixture.chip.cycle();
    EXPECT_EQ(out.busy, i < 3 ? (2u << i) - 1 : 15u);
    EXPECT_EQ(out.unit_idle, 15u & ~out.busy);
    EXPECT_FALSE(out.idle);
  }
  EXPECT_FALSE(out.launch_ready);
}

TEST(Multiprocessor, GivesPackagesToTheUnitsThatAskedAndMixesNoRays) {
  for (const size_t units : {2u, 4u}) {
    Fixture fixture(units, kRayProgram, 70);
    // The pixel identifies the package.
    fixture.chip.package = [](uint32_t n) {
      Intersection words;
      for (uint32_t i = 0; i < kIntersectionWords; ++i) words[i] = n * 100 + i;
      return words;
    };
    uint32_t packages = 0;
    for (uint32_t i = 0; i < 40; ++i) {
      const uint32_t threads = 1 + i % 8;
      packages += threads;
      fixture.launch(threads, i, i % 3 == 0 ? ImportKind::Shadow : ImportKind::Normal);
    }
    ASSERT_TRUE(fixture.chip.run());
    ASSERT_EQ(fixture.chip.requests.size(), packages);
    // Every ray is a package as it was given: its words are all of one package, and each came once.
    std::vector<uint32_t> seen;
    for (const Ray& ray : fixture.chip.rays) {
      for (uint32_t i = 0; i < kRayWords; ++i) ASSERT_EQ(ray[i], ray[0] + i);
      seen.push_back(ray[0] / 100);
    }
    std::sort(seen.begin(), seen.end());
    ASSERT_EQ(seen.size(), packages);
    for (uint32_t i = 0; i < packages; ++i) EXPECT_EQ(seen[i], i);
    EXPECT_EQ(fixture.chip.frame.size(), packages);
  }
}

TEST(Multiprocessor, TracesEveryUnitUnderItsNumber) {
  Fixture fixture(4, kStoreProgram);
  fixture.device->trace_on();
  for (uint32_t block = 0; block < 4; ++block) fixture.launch(8, block);
  std::map<uint32_t, int> retired, stores;
  for (int i = 0; i < 100; ++i) {
    fixture.chip.cycle();
    for (const RetireEvent& event : fixture.device->trace().retired) ++retired[event.unit];
    for (const StoreEvent& event : fixture.device->trace().stores) {
      ++stores[event.unit];
      EXPECT_EQ((event.address - 1024) / 64, event.unit);
    }
  }
  EXPECT_EQ(retired, (std::map<uint32_t, int>{{0, 16}, {1, 16}, {2, 16}, {3, 16}}));
  EXPECT_EQ(stores, (std::map<uint32_t, int>{{0, 2}, {1, 2}, {2, 2}, {3, 2}}));
}

TEST(Multiprocessor, ResetForgetsWhatWasUnderWay) {
  Fixture fixture(2, kRayProgram);
  fixture.chip.exports_ready = false;
  for (uint32_t i = 0; i < 4; ++i) fixture.launch(8, i, ImportKind::Normal);
  for (int i = 0; i < 200; ++i) fixture.chip.cycle();
  EXPECT_TRUE(fixture.device->outputs().export_valid);
  fixture.device->reset(size32(kRayProgram), kMemoryBytes);
  const UnitOutputs& out = fixture.device->outputs();
  EXPECT_TRUE(out.idle && out.launch_ready);
  EXPECT_FALSE(out.export_valid || out.frame_valid || out.import_request_valid || out.memory_request_valid);
  EXPECT_EQ(out.launch_unit, 0u);
}

TEST(RoundRobin, ChoosesTheNextBehindTheLast) {
  RoundRobin turn;
  std::vector<uint32_t> order;
  for (const uint32_t requests : {15u, 15u, 15u, 15u, 15u, 9u, 9u, 4u, 4u, 1u}) {
    order.push_back(turn.choose(requests));
    turn.advance(order.back());
  }
  EXPECT_EQ(order, (std::vector<uint32_t>{0, 1, 2, 3, 0, 3, 0, 2, 2, 0}));
}

}  // namespace
}  // namespace raypool
