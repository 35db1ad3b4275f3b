#include "traverser/line_cache.hpp"

#include <gtest/gtest.h>

namespace raypool::traverser {
namespace {

using Answer = LineCache::Answer;

Fetch of(uint32_t slot, uint32_t line) { return {slot, line, 1, 0}; }

TEST(LineCache, GivesALineToWhoWaitedForIt) {
  LineCache cache(16, 2, 2);
  EXPECT_EQ(cache.lookup(of(0, 5)), Answer::Missed);
  EXPECT_EQ(cache.lookup(of(1, 5)), Answer::Joined);
  EXPECT_EQ(cache.lookup(of(2, 6)), Answer::Missed);
  EXPECT_EQ(cache.lookup(of(3, 7)), Answer::Busy) << "there are two registers";
  const std::vector<Fetch> first = cache.fill(5);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0].slot, 0u);
  EXPECT_EQ(first[1].slot, 1u);
  EXPECT_EQ(cache.lookup(of(4, 5)), Answer::Hit);
  EXPECT_EQ(cache.lookup(of(3, 7)), Answer::Missed);
  EXPECT_EQ(cache.work().hits, 1u);
  EXPECT_EQ(cache.work().misses, 3u);
  EXPECT_EQ(cache.work().joined, 1u);
}

TEST(LineCache, ALookupTakesItsTimeAlsoWhereTheLineIsAboutToCome) {
  LineCache cache(16, 2, 2);
  EXPECT_EQ(cache.lookup(of(0, 5), 12), Answer::Missed);
  EXPECT_EQ(cache.lookup(of(1, 5), 12), Answer::Joined) << "nobody knows when it comes";
  cache.promise(5, 130);
  EXPECT_EQ(cache.lookup(of(2, 5), 129), Answer::Joined);
  EXPECT_EQ(cache.lookup(of(3, 5), 130), Answer::Hit);
  EXPECT_EQ(cache.lookup(of(4, 5), 131), Answer::Hit);
  EXPECT_EQ(cache.fill(5).size(), 3u);
  EXPECT_EQ(cache.work().joined, 4u);
}

TEST(LineCache, ALineMayComeBeforeSomebodyAsksForIt) {
  LineCache cache(16, 2, 1);
  EXPECT_TRUE(cache.prefetch(5));
  EXPECT_FALSE(cache.prefetch(5)) << "it is on its way";
  EXPECT_FALSE(cache.prefetch(6)) << "no register is free";
  EXPECT_EQ(cache.lookup(of(0, 5)), Answer::Joined);
  EXPECT_EQ(cache.fill(5).size(), 1u);
  EXPECT_FALSE(cache.prefetch(5)) << "it is there";
  EXPECT_TRUE(cache.prefetch(6));
  EXPECT_TRUE(cache.fill(6).empty()) << "nobody waits";
  EXPECT_EQ(cache.lookup(of(0, 6)), Answer::Hit);
  EXPECT_EQ(cache.work().misses, 2u);
  EXPECT_EQ(cache.work().joined, 1u);
}

TEST(LineCache, TheLeastRecentlyUsedLineOfTheSetGoes) {
  LineCache cache(16, 2, 4);  // 8 sets
  for (const uint32_t line : {3u, 11u}) {
    cache.lookup(of(0, line));
    cache.fill(line);
  }
  EXPECT_EQ(cache.lookup(of(0, 3)), Answer::Hit);
  cache.lookup(of(0, 19));
  cache.fill(19);
  EXPECT_EQ(cache.lookup(of(0, 3)), Answer::Hit);
  EXPECT_EQ(cache.lookup(of(0, 19)), Answer::Hit);
  EXPECT_EQ(cache.lookup(of(0, 11)), Answer::Missed);
}

TEST(LineCache, WhatItRemembersIsThereAsIfItHadJustBeenLookedUp) {
  LineCache cache(16, 2, 4);  // 8 sets
  cache.remember(3);
  cache.remember(11);
  cache.remember(3);
  cache.remember(19);
  EXPECT_EQ(cache.work().hits + cache.work().misses, 0u);
  EXPECT_EQ(cache.lookup(of(0, 3)), Answer::Hit);
  EXPECT_EQ(cache.lookup(of(0, 19)), Answer::Hit);
  EXPECT_EQ(cache.lookup(of(0, 11)), Answer::Missed);
  cache.remember(11);
  EXPECT_EQ(cache.lookup(of(1, 11)), Answer::Joined) << "it is on its way";
  EXPECT_EQ(cache.fill(11).size(), 2u);
  EXPECT_EQ(cache.lookup(of(0, 19)), Answer::Hit);
  EXPECT_EQ(cache.lookup(of(0, 3)), Answer::Missed);
}

TEST(LineCache, KeepsAsManyLinesAsItHas) {
  for (const uint32_t lines : {16u, 64u}) {
    LineCache cache(lines, 4, 1);
    for (uint32_t line = 0; line < lines; ++line) {
      cache.lookup(of(0, line));
      cache.fill(line);
    }
    for (uint32_t line = 0; line < lines; ++line) EXPECT_EQ(cache.lookup(of(0, line)), Answer::Hit);
    EXPECT_EQ(cache.lookup(of(0, lines)), Answer::Missed);
  }
}

}  // namespace
}  // namespace raypool::traverser
