// A chip's answers, each case a frame.
#include "referee/chip_contender.hpp"

#include <gtest/gtest.h>

#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"
#include "referee/corpus.hpp"
#include "referee/hardware.hpp"

namespace raypool::referee {
namespace {

std::unique_ptr<ChipDevice> chip_model(const Configuration& configuration, Memory& memory) {
  return make_chip_model(configuration, make_model(configuration, memory, 1).device);
}

TEST(ChipAnswers, OfTheModelAreThoseOfTheHardwaresHits) {
  const auto chip = chip_answers("chip", load_configuration("tiny"), chip_model);
  int hits = 0;
  for (uint64_t number = 0; number < 400; ++number) {
    const HitCase hit_case = hard_case(7, number);
    const HitAnswer expected = hardware_answer(hit_case);
    Said said;
    chip->answer(hit_case, &said);
    ASSERT_TRUE(said);
    EXPECT_EQ(said->hit, expected.hit) << number;
    if (!expected.hit || !said->hit) continue;
    ++hits;
    EXPECT_EQ(said->triangle, expected.triangle) << number;
    EXPECT_EQ(said->t, expected.t) << number;
  }
  EXPECT_GT(hits, 150);
}

}  // namespace
}  // namespace raypool::referee
