#include "config/derived_files.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <fstream>
#include <iterator>

#include "config/reference.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

/// A folder with all that marks a checkout, and the folders of the derived files.
class DerivedFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "raypool-derived-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
    for (const char* folder : {"cpp_model/isa", "rtl/include", "docs/machine", "schemas"})
      fs::create_directories(root_ / folder);
    std::ofstream(root_ / "cpp_model/isa/isa.hpp") << "\n";
  }
  void TearDown() override { fs::remove_all(root_); }
  std::string text(const std::string& path) const {
    std::ifstream file(root_ / path);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path root_;
};

TEST_F(DerivedFiles, AreAllWrittenWhereNoneIsThere) {
  const std::vector<std::string> written = write_derived_files(root_);
  EXPECT_EQ(written.size(), generated_files().size() + generated_parameter_files().size());
  for (const GeneratedFile& file : generated_files()) EXPECT_EQ(text(file.path), file.text) << file.path;
  for (const GeneratedFile& file : generated_parameter_files()) EXPECT_EQ(text(file.path), file.text) << file.path;
}

TEST_F(DerivedFiles, ThatAreRightKeepTheirTimeStamps) {
  write_derived_files(root_);
  const fs::path kept = root_ / "rtl/include/rp_isa.vh";
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(24);
  fs::last_write_time(kept, long_ago);
  const fs::file_time_type before = fs::last_write_time(kept);
  std::ofstream(root_ / "docs/machine/isa.md", std::ios::app) << "edited by hand\n";
  EXPECT_EQ(write_derived_files(root_), std::vector<std::string>{"docs/machine/isa.md"});
  EXPECT_EQ(text("docs/machine/isa.md"), isa_markdown());
  EXPECT_EQ(fs::last_write_time(kept), before);
}

TEST_F(DerivedFiles, AreNotWrittenOutsideACheckout) {
  fs::remove(root_ / "cpp_model/isa/isa.hpp");
  EXPECT_THROW(write_derived_files(root_), InputError);
  EXPECT_TRUE(fs::is_empty(root_ / "rtl/include"));
}

}  // namespace
}  // namespace raypool
