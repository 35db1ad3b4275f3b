#include "cli/output_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "config/configuration.hpp"

namespace raypool {
namespace {

std::string content(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class OutputFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) names.push_back(entry.path().filename());
    return names;
  }
  std::filesystem::path folder_;
};

TEST_F(OutputFolderTest, PublishedFilesReplaceEarlierOnes) {
  for (const char* text : {"first", "second"}) {
    OutputFolder out(folder_);
    out.write("report.json", text);
    out.publish();
  }
  EXPECT_EQ(content(folder_ / "report.json"), "second");
  EXPECT_EQ(files().size(), 1u);
}

TEST_F(OutputFolderTest, AFailedRunLeavesEarlierFilesAndNothingElse) {
  {
    OutputFolder out(folder_);
    out.write("report.json", "first");
    out.publish();
  }
  {
    OutputFolder out(folder_);
    out.write("report.json", "broken");
    out.write("image.png", "broken");
  }
  EXPECT_EQ(content(folder_ / "report.json"), "first");
  EXPECT_EQ(files().size(), 1u);
}

TEST_F(OutputFolderTest, AFolderThatIsAFileIsRefused) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "file") << "text";
  EXPECT_THROW(OutputFolder{folder_ / "file"}, InputError);
}

}  // namespace
}  // namespace raypool
