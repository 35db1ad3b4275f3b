// Corpora and answers as files: what is written is read again, bit for bit, and what is wrong is named.
#include "referee/corpus_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "bits.hpp"
#include "config/configuration.hpp"
#include "referee/corpus.hpp"

namespace raypool::referee {
namespace {

class CorpusFile : public testing::Test {
 protected:
  std::string written(const std::string& text) {
    const auto path = std::filesystem::temp_directory_path() / ("corpus_file_test_" + std::to_string(getpid()));
    std::ofstream(path) << text;
    return path_ = path.string();
  }
  void TearDown() override {
    if (!path_.empty()) std::filesystem::remove(path_);
  }
  template <typename Call>
  std::string refusal(const Call& call) {
    try {
      call();
    } catch (const InputError& error) {
      const std::string what = error.what();
      return what.substr(std::min(what.size(), path_.size()));
    }
    return "";
  }
  std::string path_;
};

TEST_F(CorpusFile, HoldsEveryBitOfItsCases) {
  std::string text;
  for (uint64_t i = 0; i < 1800; ++i) {
    const HitCase hit_case = hard_case(3, i);
    text += to_line(hit_case, certify(hit_case)) + '\n';
  }
  const std::vector<HitCase> read = read_corpus(written(text));
  ASSERT_EQ(read.size(), 1800u);
  const auto same = [](const Vec3& a, const Vec3& b) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isnan(a[axis]) ? !std::isnan(b[axis]) : as_bits(a[axis]) != as_bits(b[axis])) return false;
    }
    return true;
  };
  for (uint64_t i = 0; i < 1800; ++i) {
    const HitCase hit_case = hard_case(3, i);
    ASSERT_EQ(read[i].kind, hit_case.kind);
    ASSERT_TRUE(same(read[i].ray.origin, hit_case.ray.origin)) << i;
    ASSERT_TRUE(same(read[i].ray.direction, hit_case.ray.direction)) << i;
    ASSERT_EQ(read[i].triangles.size(), hit_case.triangles.size());
    for (size_t k = 0; k < hit_case.triangles.size(); ++k) {
      for (size_t c = 0; c < 3; ++c) ASSERT_TRUE(same(read[i].triangles[k][c], hit_case.triangles[k][c])) << i;
    }
  }
}

constexpr const char* kCase = R"({"case":0,"origin":["0","0","1"],"direction":["0","0","-0x1p+0"],"limit":"inf",)"
                              R"("triangles":[[["-1","-1","0"],["1","-1","0"],["0","1","0"]]])";

TEST_F(CorpusFile, RefusesMalformedCases) {
  const auto refusal_of = [&](const std::string& text) {
    written(text);
    return refusal([&] { read_corpus(path_); });
  };
  EXPECT_EQ(refusal_of(std::string(kCase) + "}\n"), "");
  EXPECT_EQ(refusal_of("\n"), ": has no case: give a line for each");
  EXPECT_NE(refusal_of("{\n").find(", line 1: not valid JSON"), std::string::npos);
  EXPECT_NE(refusal_of(std::string(kCase) + "}\n{\"case\":1}\n").find(", line 2:"), std::string::npos);
  EXPECT_NE(refusal_of(R"({"case":0,"origin":["0",0,"1"]})").find("origin[1]"), std::string::npos);
  EXPECT_NE(refusal_of(R"({"case":0,"origin":["0","x","1"]})").find("must be a float as a text"), std::string::npos);
  std::string infinite = kCase;
  infinite.replace(infinite.find("\"-1\""), 4, "\"inf\"");
  EXPECT_NE(refusal_of(infinite + "}").find("triangles[0][0] must be finite"), std::string::npos)
      << refusal_of(infinite + "}");
}

TEST_F(CorpusFile, RefusesACertificateThatIsNotThatOfTheNumbers) {
  written(std::string(kCase) + R"(,"allowed":[],"miss":true})");
  EXPECT_EQ(refusal([&] { read_corpus(path_); }),
            ", line 1: \"allowed\" is [], but the case's numbers give [0]: correct it or leave it out");
  written(std::string(kCase) + R"(,"allowed":[0],"miss":false})");
  EXPECT_EQ(read_corpus(path_).size(), 1u);
}

TEST_F(CorpusFile, HoldsAnAnswerACase) {
  const auto refusal_of = [&](const std::string& text) {
    written(text);
    return refusal([&] { read_answers(path_, 2); });
  };
  const std::string first = to_line(NumberedAnswer{0, {true, 3, 1.5f}}) + '\n', second = to_line(NumberedAnswer{1, {}});
  EXPECT_EQ(refusal_of(first + second), "");
  const RecordedAnswers recorded = read_answers(path_, 2);
  const auto answers = contender_of(recorded);
  Said said;
  HitCase hit_case;
  answers->answer(hit_case, &said);
  EXPECT_TRUE(said->hit && said->triangle == 3 && said->t == 1.5f);
  hit_case.number = 1;
  answers->answer(hit_case, &said);
  EXPECT_FALSE(said->hit);
  EXPECT_EQ(refusal_of(first), ": case 1 has no answer: each needs a line");
  EXPECT_EQ(refusal_of(first + first + second), ", line 2: case 0 is answered twice: keep one of them");
  EXPECT_EQ(refusal_of(first + to_line(NumberedAnswer{2, {}})),
            ", line 2: the corpus has no case 2, only those below 2");
}

}  // namespace
}  // namespace raypool::referee
