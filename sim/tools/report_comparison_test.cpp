#include "tools/report_comparison.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "config/configuration.hpp"
#include "isa/input_error.hpp"
#include "scene/image.hpp"
#include "scene/picture_file.hpp"
#include "scene/pixel_decisions.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A folder of reports, gone after the test.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("raypool_comparison_test_" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }

  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name) << text;
    return (path_ / name).string();
  }
  std::string path(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

Json report_of(const Configuration& configuration, uint64_t cycles, double flt) {
  return {{"raypool", "0.1.0"},
          {"command", {"raypool", "sim"}},
          {"config", configuration.name},
          {"configuration", Json::parse(to_json(configuration))},
          {"engine", "model"},
          {"scene", {{"name", "room"}, {"triangles", 10}, {"materials", 2}}},
          {"size", {{"width", 2}, {"height", 1}}},
          {"depth", 1},
          {"units", 2},
          {"cycles", cycles},
          {"rays", 100},
          {"mrays_per_second", 1e5 / static_cast<double>(cycles)},
          {"alus", {{"flt", {{"utilisation", flt}}}}},
          {"wall_seconds", static_cast<double>(cycles)}};
}

Json row_of(const Json& rows, const std::string& field) {
  for (const Json& row : rows)
    if (row["field"] == field) return row;
  return nullptr;
}

std::string error_of(const std::string& path) {
  try {
    load_report(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ReportComparison, ReportsWhatDiffersAndWhatThatDid) {
  const Folder folder;
  const Configuration other = load_configuration("8w8c", {"alus.flt.count=2", "chip.ray_pool.size=100"});
  folder.write("a/report.json", report_of(Configuration(), 1000, 0.5).dump());
  folder.write("b/report.json", report_of(other, 800, 0.25).dump());
  const Json comparison = compare_reports(load_report(folder.path("a")), load_report(folder.path("b/report.json")), {});
  const Json& set_up = comparison["set_up"];
  EXPECT_EQ(set_up.size(), 3u) << set_up.dump(2);
  EXPECT_EQ(row_of(set_up, "configuration.alus.flt.count")["a"], 1);
  EXPECT_EQ(row_of(set_up, "configuration.alus.flt.count")["b"], 2);
  EXPECT_EQ(row_of(set_up, "configuration.chip.ray_pool.size")["b"], 100);
  EXPECT_EQ(row_of(set_up, "configuration.name")["b"], other.name);

  const Json& results = comparison["results"];
  EXPECT_NEAR(row_of(results, "cycles")["change"].get<double>(), -0.2, 1e-9);
  EXPECT_NEAR(row_of(results, "mrays_per_second")["change"].get<double>(), 0.25, 1e-9);
  EXPECT_EQ(row_of(results, "alus.flt.utilisation")["b"], 0.25);
  EXPECT_TRUE(row_of(results, "wall_seconds").is_null()) << "what this computer did is no result";

  const std::string table = comparison_table(comparison);
  EXPECT_NE(table.find("-20.0%"), std::string::npos) << table;
  EXPECT_NE(table.find("-25.0 points"), std::string::npos) << table;
  EXPECT_NE(table.find("picture   not compared: there is no " + folder.path("a/image.png")), std::string::npos)
      << table;
}

TEST(ReportComparison, SaysHowFarEstimatesMayBeOff) {
  const Folder folder;
  folder.write("a/report.json", report_of(Configuration(), 1000, 0.5).dump());
  Json estimate = report_of(Configuration(), 990, 0.5);
  estimate["engine"] = "estimate";
  estimate["estimated"] = {{"error", 0.143}};
  folder.write("b/report.json", estimate.dump());
  const auto table = [&](const std::string& a, const std::string& b) {
    return comparison_table(compare_reports(load_report(folder.path(a)), load_report(folder.path(b)), {}));
  };
  EXPECT_NE(table("a", "b").find("estimates A exact, B +-14.3% (of the cycles)"), std::string::npos) << table("a", "b");
  EXPECT_EQ(table("a", "a").find("estimates"), std::string::npos);
}

TEST(ReportComparison, ReportsFieldsThatNeitherMachineUses) {
  const Folder folder;
  const auto compared = [&](const std::vector<std::string>& a, const std::vector<std::string>& b) {
    folder.write("a/report.json", report_of(load_configuration("8w8c", a), 1000, 0.5).dump());
    folder.write("b/report.json", report_of(load_configuration("8w8c", b), 1000, 0.5).dump());
    return compare_reports(load_report(folder.path("a")), load_report(folder.path("b")), {});
  };
  const std::string field = "configuration.chip.hardware_traverser.lanes";
  const Json unused =
      compared({"chip.traverser=static"}, {"chip.traverser=static", "chip.hardware_traverser.lanes=16"});
  EXPECT_EQ(row_of(unused["set_up"], field)["not_looked_at"], "chip.traverser is static, which has no machine inside");
  EXPECT_NE(comparison_table(unused).find("not looked at by either: chip.traverser is static"), std::string::npos);
  EXPECT_FALSE(row_of(unused["set_up"], "configuration.name").contains("not_looked_at"));
  const Json used = compared({"chip.traverser=static"}, {"chip.hardware_traverser.lanes=16"});
  EXPECT_FALSE(row_of(used["set_up"], field).contains("not_looked_at")) << "one of them looks at it";
  EXPECT_EQ(comparison_table(used).find("not looked at"), std::string::npos);
}

TEST(ReportComparison, OfTheSameRunTwiceFindsNothing) {
  const Folder folder;
  folder.write("a/report.json", report_of(Configuration(), 1000, 0.5).dump());
  const Report report = load_report(folder.path("a"));
  const Json comparison = compare_reports(report, report, {});
  EXPECT_TRUE(comparison["set_up"].empty());
  for (const Json& row : comparison["results"]) EXPECT_EQ(row["a"], row["b"]);
  EXPECT_NE(comparison_table(comparison).find("set-up    the same"), std::string::npos);
}

TEST(ReportComparison, AReportWithoutAChipHadTheDefaultOne) {
  const Folder folder;
  Json before = report_of(Configuration(), 1000, 0.5);
  before["configuration"].erase("chip");
  folder.write("a/report.json", before.dump());
  folder.write("b/report.json", report_of(load_configuration("8w8c", {"chip.memory.latency=60"}), 1000, 0.5).dump());
  const Json comparison = compare_reports(load_report(folder.path("a")), load_report(folder.path("b")), {});
  EXPECT_EQ(comparison["set_up"].size(), 2u) << comparison["set_up"].dump(2);
  EXPECT_EQ(row_of(comparison["set_up"], "configuration.chip.memory.latency")["a"], 120);
}

TEST(ReportComparison, WhatOneReportLacksIsNull) {
  const Folder folder;
  Json untimed = report_of(Configuration(), 1000, 0.5);
  untimed["cycles"] = nullptr;
  untimed.erase("alus");
  folder.write("a/report.json", untimed.dump());
  folder.write("b/report.json", report_of(Configuration(), 1000, 0.5).dump());
  const Json comparison = compare_reports(load_report(folder.path("a")), load_report(folder.path("b")), {});
  EXPECT_TRUE(row_of(comparison["results"], "cycles")["a"].is_null());
  EXPECT_TRUE(row_of(comparison["results"], "cycles")["change"].is_null());
  EXPECT_EQ(row_of(comparison["results"], "alus.flt.utilisation")["b"], 0.5);
  EXPECT_FALSE(comparison_table(comparison).empty());
}

TEST(ReportComparison, CountsThePixelsThatDiffer) {
  const Folder folder;
  const auto draw = [&](const std::string& name, float second) {
    folder.write(name + "/report.json", report_of(Configuration(), 1000, 0.5).dump());
    FrameBuffer frame(2, 1);
    FrameContribution pixel{};
    pixel.pixel = 1;
    uint32_t bits = 0;
    std::memcpy(&bits, &second, 4);
    pixel.rgb = {bits, 0, 0};
    frame.add(pixel);
    write_png(frame, folder.path(name + "/image.png"));
    return load_report(folder.path(name));
  };
  const Report a = draw("a", 0), b = draw("b", 1);
  const Json picture = compare_reports(a, b, {})["picture"];
  EXPECT_EQ(picture["pixels"], 2);
  EXPECT_EQ(picture["differ"], 1);
  EXPECT_EQ(picture["off_by_more"], 0.5);
  EXPECT_EQ(picture["largest_difference"], 255);
  EXPECT_NEAR(picture["mean_difference"].get<double>(), 255.0 / 6, 1e-9);
  EXPECT_NEAR(picture["psnr"].get<double>(), 10 * std::log10(6.0), 1e-9);
  EXPECT_EQ(compare_reports(a, a, {})["picture"]["differ"], 0);
  EXPECT_TRUE(compare_reports(a, a, {})["picture"]["psnr"].is_null());
  EXPECT_EQ(compare_reports(a, a, {})["picture"]["off_by_more"], 0.0);
  EXPECT_NE(
      comparison_table(compare_reports(a, b, {}))
          .find("picture   1 of 2 pixels differ, 50.000% of the picture by 2 or more; largest difference 255 of "),
      std::string::npos);
  EXPECT_EQ(compare_reports(a, b, {})["criterion"], (Json{{"off_by", 2}, {"most_off", 0.01}}));
}

/// Folders of two pictures of two pixels, of which the second one differs.
struct TwoPictures {
  TwoPictures() {
    for (const std::string name : {"a", "b"}) {
      folder.write(name + "/report.json", report_of(Configuration(), 1, 1).dump());
      FrameBuffer frame(2, 1);
      frame.add({1, {name == "b" ? 0x3f800000u : 0u, 0, 0}});
      write_png(frame, folder.path(name + "/image.png"));
    }
  }
  void decide(const std::string& name, const PixelDecisions& decisions) const {
    folder.write(name + "/decisions.bin", decisions.to_bytes());
  }
  Json compared(const std::string& map = "") const {
    return compare_reports(load_report(folder.path("a")), load_report(folder.path("b")), {}, map)["picture"];
  }

  Folder folder;
};

TEST(ReportComparison, ReportsWhyPixelsDiffer) {
  const TwoPictures pictures;
  EXPECT_FALSE(pictures.compared().contains("causes")) << "no run has left what rays come to";
  const std::string map = pictures.folder.path("map.png");
  EXPECT_THROW(pictures.compared(map), InputError);
  EXPECT_FALSE(fs::exists(map));

  PixelDecisions a(2, 1), b(2, 1);
  a.hit(0, 1);  // nothing is reported of the pixel that is the same
  a.hit(1, 3);
  b.hit(1, 3);
  b.shadow(1, true);
  pictures.decide("a", a);
  EXPECT_THROW(pictures.compared(map), InputError) << "one has";
  pictures.decide("b", b);
  EXPECT_EQ(pictures.compared(map)["causes"], (Json{{"hit", 0}, {"shadow", 1}, {"colour", 0}}));
  const Picture drawn = read_png(map);
  EXPECT_EQ(drawn.rgb, (std::vector<uint8_t>{0, 0, 0, 60, 120, 255}));
  b.miss(1);
  pictures.decide("b", b);
  EXPECT_EQ(pictures.compared()["causes"], (Json{{"hit", 1}, {"shadow", 0}, {"colour", 0}}));
  pictures.decide("b", PixelDecisions(1, 2));
  EXPECT_THROW(pictures.compared(), InputError) << "of another picture";
}

TEST(ReportComparison, TakesTheAreaOfTheSameVerilog) {
  const Folder folder;
  Json synthesis = {{"memories", "macros"}, {"area", {{"total_kge", 100.0}}}, {"forty_nm", {{"total_mm2", 0.5}}}};
  for (const auto& [name, value] : verilog_parameters(Configuration()))
    synthesis["parameters"][name] = std::to_string(value);
  folder.write("synth/8w8c/report.json", synthesis.dump());
  folder.write("synth/broken/report.json", "{");
  folder.write("a/report.json", report_of(load_configuration("8w8c", {"chip.ray_pool.size=7"}), 1000, 0.5).dump());
  folder.write("b/report.json", report_of(load_configuration("8w8c", {"warps=4"}), 1000, 0.5).dump());
  const Report a = load_report(folder.path("a")), b = load_report(folder.path("b"));
  const Json area = compare_reports(a, b, {folder.path("synth")})["area"];
  EXPECT_EQ(area["a"]["mm2"], 1.0) << "two units";
  EXPECT_EQ(area["a"]["kge"], 200.0);
  EXPECT_EQ(area["a"]["mrays_per_second_mm2"], 100.0);
  EXPECT_TRUE(area["b"].is_null());
  EXPECT_THROW(compare_reports(a, b, {folder.path("synth/broken/report.json")}), InputError);
  EXPECT_THROW(compare_reports(a, b, {folder.path("a/report.json")}), InputError) << "no report of synthesis";
}

TEST(ReportComparison, SaysWhatFindsAnAreaThatIsNotKnown) {
  const Folder folder;
  const auto found = [&](const Json& command) {
    Json report = report_of(load_configuration("8w8c"), 1000, 0.5);
    report["command"] = command;
    folder.write("a/report.json", report.dump());
    const std::string table =
        comparison_table(compare_reports(load_report(folder.path("a")), load_report(folder.path("a")), {}));
    const size_t begin = table.find("area A");
    return table.substr(begin, table.find('\n', begin) - begin);
  };
  EXPECT_EQ(found({"raypool", "sim"}), "area A    not known; `make synth CONFIG=8w8c` finds it");
  EXPECT_EQ(found({"raypool", "sim", "--config=4w4c", "--set=data_cache.bytes=2048 chip.ray_pool.size=64", "--size",
                   "8x8", "--set", "warps=2"}),
            "area A    not known; `make synth CONFIG=4w4c SET=\"data_cache.bytes=2048 warps=2\"` finds it");
  EXPECT_EQ(found({"raypool", "sim", "--config", "mine.json"}),
            "area A    not known; `make synth CONFIG=mine.json` finds it");
  EXPECT_EQ(found(nullptr), "area A    not known; `make synth CONFIG=...` finds it");
}

TEST(ReportComparison, AMalformedReportIsOneSentence) {
  const Folder folder;
  EXPECT_EQ(
      error_of(folder.write("broken.json", "{\"raypool\": ")).find(folder.path("broken.json") + ": not valid JSON"),
      0u);
  for (const char* text : {"3", "[]", "{}", R"({"raypool": 3})", R"({"name": "8w8c"})"}) {
    EXPECT_EQ(error_of(folder.write("foreign.json", text)),
              folder.path("foreign.json") + ": not a report of raypool sim: it has no 'raypool' as those have");
  }
  Json cut = report_of(Configuration(), 1000, 0.5);
  cut["units"] = "two";
  EXPECT_NE(error_of(folder.write("cut.json", cut.dump())).find("it has no 'units'"), std::string::npos);
  EXPECT_NE(error_of(folder.path("none")).find("none"), std::string::npos);
  EXPECT_EQ(error_of(""),
            "compare takes two reports of raypool sim, or the folders that they are in: raypool compare A B, or make "
            "compare A=FOLDER B=FOLDER");
}

}  // namespace
}  // namespace raypool
