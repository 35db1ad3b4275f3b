#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "files/output_files.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string content(const std::string& name) const { return read_file((folder_ / name).string(), "file"); }
  size_t entries() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  template <typename Action>
  static std::string error_of(const Action& action) {
    try {
      action();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  fs::path folder_;
};

TEST_F(Files, AFileIsReplacedAndKeepsItsPermissions) {
  write_file(folder_ / "a", "first, which is longer");
  chmod((folder_ / "a").c_str(), 0600);
  write_file(folder_ / "a", "second");
  EXPECT_EQ(content("a"), "second");
  EXPECT_EQ(fs::status(folder_ / "a").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(entries(), 1u);
}

TEST_F(Files, ALinkIsFollowedAlsoToAFileThatIsNotThereYet) {
  fs::create_directory(folder_ / "below");
  fs::create_symlink("below/target", folder_ / "link");
  fs::create_symlink("link", folder_ / "link_to_link");
  for (const std::string text : {"first", "second"}) {
    write_file(folder_ / "link_to_link", text);
    EXPECT_TRUE(fs::is_symlink(folder_ / "link_to_link"));
    EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
    EXPECT_FALSE(fs::is_symlink(folder_ / "below/target"));
    EXPECT_EQ(content("below/target"), text);
  }
  fs::create_symlink("ring", folder_ / "ring");
  EXPECT_NE(error_of([&] { write_file(folder_ / "ring", "text"); }).find("Too many levels of symbolic links"),
            std::string::npos);
}

TEST_F(Files, AFifoIsWrittenThrough) {
  const fs::path fifo = folder_ / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  std::string text;
  std::thread reader([&] { text = content("fifo"); });
  write_file(fifo, "through");
  reader.join();
  EXPECT_EQ(text, "through");
  EXPECT_TRUE(fs::is_fifo(fifo));
  OutputFiles files;
  EXPECT_NE(error_of([&] { files.begin(fifo, true); }).find("regular file"), std::string::npos);
}

TEST_F(Files, AFullDeviceIsAnErrorWithTheSystemsReasonAndStays) {
  EXPECT_EQ(error_of([] { write_file("/dev/full", "text"); }), "cannot write to '/dev/full' (No space left on device)");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(Files, OfSeveralThatCannotAllBeWrittenNoneIs) {
  write_file(folder_ / "a", "earlier");
  {
    OutputFiles files;
    files.write(folder_ / "a", "later");
    files.write(folder_ / "b", "later");
    EXPECT_NE(error_of([&] { files.write(folder_ / "none" / "c", "later"); }).find("No such file or directory"),
              std::string::npos);
    files.write("/dev/full", "later");
    EXPECT_NE(error_of([&] { files.publish(); }).find("No space left on device"), std::string::npos);
  }
  EXPECT_EQ(content("a"), "earlier");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(Files, AFolderIsNeitherReadNorWritten) {
  EXPECT_NE(error_of([&] { write_file(folder_, "text"); }).find("Is a directory"), std::string::npos);
  EXPECT_NE(error_of([&] { write_file(folder_ / "", "text"); }).find("Is a directory"), std::string::npos);
  EXPECT_EQ(error_of([&] { read_file(folder_.string(), "view file"); }),
            folder_.string() + ": the view file cannot be read (Is a directory); check the path");
}

TEST_F(Files, TextIsReadWithoutItsByteOrderMark) {
  const auto read = [&](const std::string& bytes) {
    write_file(folder_ / "a", bytes);
    return read_text_file((folder_ / "a").string(), "view file");
  };
  EXPECT_EQ(read("\xef\xbb\xbftext\n"), "text\n");
  EXPECT_EQ(read("\xef\xbb\xbf\xef\xbb\xbf{}"), "{}");
  EXPECT_EQ(read("\xef\xbb\xbf"), "");
  for (const std::string plain : {"", "\xef", "a\xef\xbb\xbf", "\xc3\xa4", "ply\n"}) EXPECT_EQ(read(plain), plain);
}

TEST_F(Files, WideTextIsRefusedInOneSentence) {
  using namespace std::string_literals;
  const auto refusal = [&](const std::string& bytes) {
    write_file(folder_ / "a", bytes);
    return error_of([&] { read_text_file((folder_ / "a").string(), "view file"); });
  };
  const std::string start = (folder_ / "a").string() + ": the view file is ";
  for (const std::string& bytes : {"\xff\xfe{\0}\0"s, "\xfe\xff\0{\0}"s, "\xff\xfe"s, "v\0 \0"s, "\0v\0 \0001"s})
    EXPECT_EQ(refusal(bytes), start + "UTF-16 text, which is not read; save it as UTF-8");
  for (const std::string& bytes : {"\xff\xfe\0\0{\0\0\0"s, "\0\0\xfe\xff\0\0\0{"s, "{\0\0\0"s, "\0\0\0{"s})
    EXPECT_EQ(refusal(bytes), start + "UTF-32 text, which is not read; save it as UTF-8");
}

TEST(Text, EveryEndOfALineBecomesALineFeed) {
  const auto read = [](std::string text) {
    use_line_feeds(text);
    return text;
  };
  EXPECT_EQ(read("a\rb\r\rc"), "a\nb\n\nc");
  EXPECT_EQ(read("a\r\nb\r\r\nc\n\nd\r"), "a\nb\nc\n\nd\n");
  EXPECT_EQ(read("\n\r\n"), "\n\n");
  EXPECT_EQ(read(""), "");
}

TEST(JsonText, AKeyTwiceInOneObjectIsRefusedAndInTwoIsNot) {
  EXPECT_EQ(parse_json(R"({"a": {"b": 1}, "c": {"b": 2}, "d": [{"b": 3}, {"b": 4}]})", "x").size(), 3u);
  for (const std::string text : {R"({"a": 1, "b": 2, "a": 3})", R"([{"c": {"a": 1, "a": 1}}])"}) {
    try {
      parse_json(text, "file.json");
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(), "file.json: the key \"a\" stands twice in one object: keep one of them");
    }
  }
}

TEST(JsonText, MalformedJsonIsAnInputErrorWithoutTheLibrarysTag) {
  try {
    parse_json("{\"a\": \xe9}", "file.json");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("file.json: not valid JSON: parse error at line 1, column 7"), 0u)
        << error.what();
  }
}

TEST(JsonText, ANameThatIsNotUtf8CanBeWritten) {
  EXPECT_EQ(to_text({{"scene", "caf\xe9.obj"}}, 0), "{\n\"scene\": \"caf\xef\xbf\xbd.obj\"\n}");
}

}  // namespace
}  // namespace raypool
