#include "numerics/significands.hpp"

#include <gtest/gtest.h>

#include "config/parameter_table.hpp"
#include "config/settings.hpp"
#include "scene/double_renderer.hpp"
#include "scene/image.hpp"
#include "scene/traversal.hpp"

namespace raypool::numerics {
namespace {

NativeOptions small_frame() {
  NativeOptions frame;
  frame.width = 64;
  frame.height = 48;
  frame.depth = 3;
  return frame;
}

const Scene& room() {
  static const Scene scene = make_room(0.05);
  return scene;
}
const std::vector<SignificandRow>& rows_of_room() {
  static const std::vector<SignificandRow> rows = try_significands(room(), load_configuration("4w4c"), small_frame());
  return rows;
}

TEST(Significands, AllOfThemAreHeldAgainstDoublePrecision) {
  const MemoryImage image = build_memory(ray_kernel_program(), room());
  const Tracer tracer(room(), image.material_base, load_configuration("4w4c").chip);
  NativeStatistics none;
  const FrameBuffer truth = render_in_double(room(), image, tracer, small_frame(), none, nullptr);
  ASSERT_EQ(rows_of_room().size(), arith::kFullSignificand - arith::kLeastSignificand + 1);
  for (const SignificandRow& row : {rows_of_room().front(), rows_of_room().back()}) {
    NativeOptions options = small_frame();
    options.mode.significand = row.significand;
    const ImageDifference difference = compare(truth, render_native(room(), image, tracer, options));
    EXPECT_EQ(row.difference.differ, difference.visible) << row.significand;
    EXPECT_EQ(row.difference.psnr, difference.psnr) << row.significand;
  }
}

TEST(Significands, TheFullOneHasTheErrorOfSinglePrecision) {
  const SignificandRow& full = rows_of_room().front();
  EXPECT_EQ(full.significand, arith::kFullSignificand);
  EXPECT_GT(full.difference.differ, 0u) << "it is not its own reference";
  EXPECT_TRUE(full.difference.passes());
}

TEST(Significands, FewerBitsDrawWorse) {
  const std::vector<SignificandRow>& rows = rows_of_room();
  for (size_t i = 2; i < rows.size(); ++i)
    EXPECT_GE(rows[i].difference.off_by_more, rows[i - 2].difference.off_by_more) << rows[i].significand;
  const SignificandRow &full = rows.front(), &least = rows.back();
  EXPECT_GT(least.difference.off_by_more, 20 * full.difference.off_by_more);
  for (size_t cause = 0; cause < kPixelCauses; ++cause)
    EXPECT_GT(least.causes[cause], full.causes[cause]) << kPixelCauseNames[cause];
}

TEST(Significands, EachPixelThatDiffersHasACause) {
  for (const SignificandRow& row : rows_of_room())
    EXPECT_EQ(row.causes[0] + row.causes[1] + row.causes[2], row.difference.differ) << row.significand;
}

/// From the full significand on, of which so many of a thousand pixels are off.
std::vector<SignificandRow> rows_off_by(const std::vector<uint64_t>& off) {
  std::vector<SignificandRow> rows;
  for (const uint64_t pixels : off) {
    SignificandRow row;
    row.significand = arith::kFullSignificand - static_cast<uint32_t>(rows.size());
    row.difference.pixels = 1000;
    row.difference.off_by_more = pixels;
    rows.push_back(row);
  }
  return rows;
}

TEST(Significands, OnePercentOfThePixelsMayBeOff) {
  EXPECT_EQ(smallest_passing(rows_off_by({0, 9, 10, 11})), 22u);
  EXPECT_EQ(smallest_passing(rows_off_by({10, 11, 10})), 24u) << "all above must pass too";
  EXPECT_EQ(smallest_passing(rows_off_by({11, 0})), std::nullopt);
}

TEST(Significands, TheTableNamesTheSmallestThatPasses) {
  const auto ends_with = [](const std::string& text, const std::string& end) {
    return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
  };
  const std::string table = significand_table(rows_off_by({0, 9, 10, 11}));
  EXPECT_NE(table.find("\n  22    1.000% "), std::string::npos) << table;
  EXPECT_TRUE(ends_with(table, "smallest with at most 1% of the pixels off by 2 or more: 22 bits\n")) << table;
  EXPECT_TRUE(ends_with(significand_table(rows_off_by({11})), "off by 2 or more: none\n"));
}

}  // namespace
}  // namespace raypool::numerics
