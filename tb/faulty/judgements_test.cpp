#include "faulty/judgements.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "isa/input_error.hpp"

namespace raypool::faulty {
namespace {

std::string file_with(const std::string& text) {
  std::string path = testing::TempDir() + "judged.json";
  std::ofstream(path) << text;
  return path;
}

TEST(Judgements, AreUpToDateWhenTheSurvivorsAreThoseOfTheFile) {
  Judgements judgements(file_with(R"({"mutants": [{"survivor": "a", "equivalent": true, "reason": "r"},
                                                  {"survivor": "b", "equivalent": false, "reason": "s"}],
                                      "blocks": [{"survivor": "c", "equivalent": true, "reason": "t"}]})"),
                        "mutants");
  EXPECT_EQ(judgements.survived("a"), "equivalent: r");
  EXPECT_FALSE(judgements.up_to_date()) << "b did not survive yet";
  EXPECT_EQ(judgements.survived("b"), "a gap: s");
  EXPECT_EQ(judgements.equivalent(), 1);
  EXPECT_TRUE(judgements.up_to_date());
  EXPECT_EQ(judgements.survived("c"), "NOT JUDGED");
  EXPECT_EQ(judgements.open(), 1);
  EXPECT_FALSE(judgements.up_to_date());
}

TEST(Judgements, AreNotAskedForWithoutAFile) {
  Judgements judgements("", "mutants");
  EXPECT_EQ(judgements.survived("a"), "NOT JUDGED");
  EXPECT_TRUE(judgements.up_to_date());
}

TEST(Judgements, OfABrokenFileAreRefusedWithItsName) {
  for (const char* text : {"[", R"({"mutants": [{"survivor": "a", "equivalent": true}]})", R"({"blocks": []})"}) {
    try {
      Judgements broken(file_with(text), "mutants");
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("judged.json"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(Judgements("no such file", "mutants"), InputError);
}

}  // namespace
}  // namespace raypool::faulty
