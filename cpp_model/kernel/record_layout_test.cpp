#include "kernel/record_layout.hpp"

#include <gtest/gtest.h>

#include "kernel/compiler.hpp"
#include "kernel/kernels.hpp"

namespace raypool::kernel {
namespace {

using Int = RecordedKernel::Int;

template <typename... Bodies>
RecordLayout layout_of(const Bodies&... bodies) {
  std::vector<Function> kernels;
  (kernels.push_back(record_kernel("k", bodies)), ...);
  return compact_layout(kernels);
}

/// Writes the words of a ray but for some.
void set_ray(RecordedKernel& k, const Int& value, uint32_t but = 0) {
  for (int word = 0; word < kRayWords; ++word)
    if ((but >> word & 1) == 0) k.set_word(word, value);
}

std::vector<int> words_in(const RecordLayout& layout) {
  std::vector<int> words;
  for (int word = 0; word < kIntersectionWords; ++word)
    if (layout.place[word] != RecordLayout::kAbsent) words.push_back(word);
  return words;
}

TEST(RecordLayout, HasWhatIsReadAndWhatIsExportedAsItCame) {
  const RecordLayout layout = layout_of(
      [](RecordedKernel& k) {
        k.ray_in();
        const Int sum = k.int_word(15) + k.int_word(3);
        [[maybe_unused]] const Int unused = k.int_word(20);
        set_ray(k, sum, 1u << 7);
        k.ray_out();
        set_ray(k, sum);
        k.ray_out();
      },
      [](RecordedKernel& k) {
        k.ray_in();
        k.set_word(8, k.thread());
        k.frame_out();
      },
      [](RecordedKernel& k) { k.set_word(0, k.thread()); });
  EXPECT_EQ(words_in(layout), (std::vector<int>{3, 7, 9, 10, 15}));
  EXPECT_EQ(layout.place[3], 3);
  EXPECT_EQ(layout.place[15], 0) << "where no kernel needs what comes";
  EXPECT_EQ(layout.words, 12u);
}

TEST(RecordLayout, CountsAWordAsWrittenWhenAllThreadsWriteIt) {
  const RecordLayout layout = layout_of([](RecordedKernel& k) {
    k.ray_in();
    set_ray(k, k.thread(), 1u << 5);
    k.if_(k.thread() < 3, [&] { k.set_word(5, k.thread()); });
    k.ray_out();
  });
  EXPECT_EQ(words_in(layout), std::vector<int>{5});
}

TEST(RecordLayout, SharesNoPlaceThatAKernelWritesBeforeItReads) {
  const auto early = [](RecordedKernel& k) {
    k.ray_in();
    const Int hit = k.int_word(12) + k.int_word(13);
    set_ray(k, hit);
    k.ray_out();
  };
  const auto late = [](RecordedKernel& k) {
    k.ray_in();
    set_ray(k, k.thread(), 1u << 4);
    k.set_word(4, k.int_word(12));
    k.ray_out();
  };
  EXPECT_EQ(layout_of(early).place[12], 0);
  EXPECT_EQ(layout_of(early).place[13], 1);
  const RecordLayout both = layout_of(early, late);
  EXPECT_EQ(both.place[12], 4) << "read before 4 is written, and after all others";
  EXPECT_EQ(both.place[13], 0);
}

TEST(RecordLayout, SharesNothingInAKernelWithALoop) {
  const RecordLayout layout = layout_of([](RecordedKernel& k) {
    k.ray_in();
    Int sum = k.thread();
    k.while_([&] { return sum < 100; }, [&] { sum = sum + k.int_word(17); });
    set_ray(k, sum);
    k.ray_out();
  });
  EXPECT_EQ(layout.place[17], 12);
  EXPECT_EQ(layout.words, 13u);
}

TEST(RecordLayout, OfTheRayKernelsHas16Words) {
  Configuration configuration;
  configuration.intersection_words = 16;
  for (const int features : {0, 1, 2, 3}) {
    configuration.fma = (features & 1) != 0;
    configuration.triples = (features & 2) != 0;
    const RecordLayout layout = ray_record_layout(configuration);
    EXPECT_EQ(layout.words, 16u);
    EXPECT_EQ(words_in(layout), (std::vector<int>{0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12, 15, 16, 17, 18}));
    EXPECT_EQ(layout.place[word::kDistance], word::kLimit);
    uint32_t places = 0;
    for (const uint8_t place : layout.place) places |= place == RecordLayout::kAbsent ? 0 : 1u << place;
    EXPECT_EQ(places, 0xffffu) << "each word has a place of its own";
  }
}

TEST(RecordLayout, IsTheWholeIntersectionByDefault) {
  const RecordLayout layout = ray_record_layout({});
  EXPECT_EQ(layout.words, 21u);
  for (int word = 0; word < kIntersectionWords; ++word) EXPECT_EQ(layout.place[word], word);
}

TEST(RecordLayout, NamesKernelsWithTooFewWords) {
  Configuration configuration;
  configuration.intersection_words = 15;
  try {
    ray_record_layout(configuration);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "configuration 8w8c: intersection_words is 15, but the ray kernels need 16 words of an intersection; it "
        "must lie in 16 .. 21");
  }
}

TEST(RecordLayout, ForgetsReadsOfAWordThatIsLeftOutWhereNothingUsesThem) {
  Function kernel = record_kernel("k", [](RecordedKernel& k) {
    k.ray_in();
    const Int used = k.int_word(15);
    [[maybe_unused]] const Int unused = k.int_word(18);
    set_ray(k, used);
    k.ray_out();
  });
  const RecordLayout layout = compact_layout({kernel});
  place_words(kernel, layout);
  std::vector<int> read;
  for (const Op& op : kernel.ops)
    if (is(op, Opcode::Rld)) read.push_back(op.word);
  EXPECT_EQ(read, std::vector<int>{layout.place[15]});
}

TEST(RecordLayout, LetsNoKernelReadAWordThatIsLeftOut) {
  RecordLayout layout;
  layout.place[19] = RecordLayout::kAbsent;
  EXPECT_THROW(record_kernel(
                   "k", [](RecordedKernel& k) { k.set_word(0, k.int_word(19)); }, {}, layout),
               InputError);
}

}  // namespace
}  // namespace raypool::kernel
