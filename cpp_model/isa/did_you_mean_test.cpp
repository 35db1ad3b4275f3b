#include "isa/did_you_mean.hpp"

#include <gtest/gtest.h>

namespace raypool {
namespace {

using Names = std::vector<std::string>;

const Names kEngines = {"native", "functional", "sampled", "model", "rtl", "lockstep"};

TEST(DidYouMean, EachMistakeOfALetterCountsOnce) {
  EXPECT_EQ(spelling_distance("", ""), 0u);
  EXPECT_EQ(spelling_distance("", "sim"), 3u);
  EXPECT_EQ(spelling_distance("sim", ""), 3u);
  EXPECT_EQ(spelling_distance("sim", "sim"), 0u);
  EXPECT_EQ(spelling_distance("smi", "sim"), 1u) << "swapped";
  EXPECT_EQ(spelling_distance("sin", "sim"), 1u) << "changed";
  EXPECT_EQ(spelling_distance("siim", "sim"), 1u) << "added";
  EXPECT_EQ(spelling_distance("si", "sim"), 1u) << "removed";
  EXPECT_EQ(spelling_distance("modle", "model"), 1u);
  EXPECT_EQ(spelling_distance("locsktpe", "lockstep"), 2u);
  EXPECT_EQ(spelling_distance("kitten", "sitting"), 3u);
}

TEST(DidYouMean, DistancesAreThoseOfBothDirections) {
  for (const std::string& a : kEngines)
    for (const std::string& b : kEngines) EXPECT_EQ(spelling_distance(a, b), spelling_distance(b, a)) << a << " " << b;
}

TEST(DidYouMean, TheNearestNamesAreFound) {
  EXPECT_EQ(nearest_names("modle", kEngines), Names{"model"});
  EXPECT_EQ(nearest_names("RTL", kEngines), Names{"rtl"});
  EXPECT_EQ(nearest_names("lock", kEngines), Names{"lockstep"}) << "cut short";
  EXPECT_EQ(nearest_names("rom", {"cornell", "room"}), Names{"room"});
  EXPECT_EQ(nearest_names("--look_at", {"--look-at", "--light"}), Names{"--look-at"});
  EXPECT_EQ(nearest_names("tra", {"traverser", "trace"}), Names{"trace"}) << "the shorter one is nearer";
  EXPECT_EQ(nearest_names("add", {"iadd", "fadd", "and"}), (Names{"iadd", "fadd", "and"})) << "in their order";
}

TEST(DidYouMean, WhatIsFarFromAllNamesHasNoNearest) {
  EXPECT_EQ(nearest_names("spice", kEngines), Names());
  EXPECT_EQ(nearest_names("", kEngines), Names());
  EXPECT_EQ(nearest_names("x", {"n", "o"}), Names()) << "no letter is right";
  EXPECT_EQ(nearest_names("r", kEngines), Names()) << "a letter is no beginning";
  EXPECT_EQ(nearest_names("model", {}), Names());
}

TEST(DidYouMean, AMessageAsksForAtMostThreeNames) {
  EXPECT_EQ(did_you_mean("modle", kEngines, "use rtl or model"), ": did you mean model? (use rtl or model)");
  EXPECT_EQ(did_you_mean("spice", kEngines, "use rtl or model"), "; use rtl or model");
  EXPECT_EQ(did_you_mean("modle", kEngines, ""), ": did you mean model?");
  EXPECT_EQ(did_you_mean("spice", kEngines, ""), "");
  EXPECT_EQ(did_you_mean({"a", "b"}, ""), ": did you mean a or b?");
  EXPECT_EQ(did_you_mean({"a", "b", "c", "d"}, ""), ": did you mean a, b or c?");
}

}  // namespace
}  // namespace raypool
