// The judge: each fault by its name, and bugs that are seeded in our hits are found soon.
#include "referee/judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bits.hpp"
#include "referee/corpus.hpp"
#include "referee/hardware.hpp"
#include "referee/minimise.hpp"
#include "referee/table.hpp"

namespace raypool::referee {
namespace {

/// Two walls of two triangles each; the second one is behind the first.
HitCase walls() {
  HitCase hit_case;
  hit_case.ray = {{1, 0.5f, 8}, {0, 0, -1}, INFINITY};
  for (const float z : {0.0f, -1.0f}) {
    hit_case.triangles.push_back({Vec3{-9, -9, z}, Vec3{9, -9, z}, Vec3{9, 9, z}});
    hit_case.triangles.push_back({Vec3{-9, -9, z}, Vec3{9, 9, z}, Vec3{-9, 9, z}});
  }
  return hit_case;
}

Verdict of(const HitCase& hit_case, const HitAnswer& answer) { return judge(hit_case, certify(hit_case), answer); }

TEST(Judge, NamesWhatIsWrong) {
  const HitCase hit_case = walls();
  EXPECT_TRUE(of(hit_case, {true, 0, 8}).right);
  EXPECT_TRUE(of(hit_case, {}).has(Fault::LostHit));
  EXPECT_TRUE(of(hit_case, {}).has(Fault::Crack));
  EXPECT_TRUE(of(hit_case, {true, 1, 8}).has(Fault::WrongTriangle));
  EXPECT_FALSE(of(hit_case, {true, 1, 8}).has(Fault::Crack)) << "the neighbour is not behind";
  EXPECT_TRUE(of(hit_case, {true, 2, 9}).has(Fault::WrongTriangle));
  EXPECT_TRUE(of(hit_case, {true, 2, 9}).has(Fault::Crack));
  EXPECT_TRUE(of(hit_case, {true, 77, 8}).has(Fault::WrongTriangle)) << "there is no such triangle";
  HitCase away = hit_case;
  away.ray.direction.z = 1;
  EXPECT_TRUE(of(away, {}).right);
  EXPECT_TRUE(of(away, {true, 0, 8}).has(Fault::FalseHit));
}

TEST(Judge, AtAnOutlineARayThatIsLetThroughIsNoCrack) {
  HitCase hit_case = walls();
  hit_case.ray.origin = {std::nextafter(9.0f, 0.0f), 0, 8};
  EXPECT_TRUE(of(hit_case, {}).has(Fault::LostHit));
  EXPECT_FALSE(of(hit_case, {}).has(Fault::Crack));
}

TEST(Judge, MeasuresTInUnitsOfItsLastPlace) {
  const HitCase hit_case = walls();
  EXPECT_EQ(of(hit_case, {true, 0, 8}).error, 0);
  EXPECT_EQ(of(hit_case, {true, 0, as_float(as_bits(8.0f) + 3)}).error, 3);
  EXPECT_TRUE(std::isinf(of(hit_case, {true, 0, INFINITY}).error));
  HitCase third = hit_case;
  third.ray.direction.z = -3;  // t is 8/3, between two floats
  const double error = of(third, {true, 0, 8.0f / 3}).error;
  EXPECT_GT(error, 0.3);
  EXPECT_LE(error, 0.5);
}

// ---- Bugs in our hits, as a designer would make them, whatever the definition is

/// A side of a triangle is not part of it: a ray exactly on it misses.
HitAnswer with_an_open_edge(const HitCase& hit_case) {
  HitCase left = hit_case;
  std::vector<uint32_t> numbers;
  left.triangles.clear();
  for (uint32_t i = 0; i < hit_case.triangles.size(); ++i) {
    HitCase alone = hit_case;
    alone.triangles = {hit_case.triangles[i]};
    // On the edge from corner 0 to corner 1 it is if a triangle with the opposite corner elsewhere has it there too.
    const auto& corners = hit_case.triangles[i];
    alone.triangles.push_back({corners[0], corners[1], corners[0] + corners[1] - corners[2]});
    const Certificate certificate = certify(alone);
    const Meeting* const met = certificate.meeting(0);
    const bool on_edge = met != nullptr && met->passing == Passing::Edge && certificate.meeting(1) != nullptr;
    if (on_edge) continue;
    left.triangles.push_back(corners);
    numbers.push_back(i);
  }
  HitAnswer answer = hardware_answer(left);
  if (answer.hit) answer.triangle = numbers[answer.triangle];
  return answer;
}

/// A hit at the limit counts.
HitAnswer with_a_closed_limit(const HitCase& hit_case) {
  HitCase longer = hit_case;
  if (longer.ray.limit > 0 && !std::isinf(longer.ray.limit)) {
    longer.ray.limit = std::nextafter(longer.ray.limit, INFINITY);
  }
  return hardware_answer(longer);
}

/// Two hits with t that differ in the last place are taken for a tie, which the lower number wins.
HitAnswer with_a_wide_tie(const HitCase& hit_case) {
  HitAnswer best;
  for (uint32_t i = 0; i < hit_case.triangles.size(); ++i) {
    HitCase alone = hit_case;
    alone.triangles = {hit_case.triangles[i]};
    const HitAnswer found = hardware_answer(alone);
    if (found.hit && (!best.hit || as_bits(found.t) + 1 < as_bits(best.t))) best = {true, i, found.t};
  }
  return best;
}

/// The first case that a bug spoils, which must come among the first 1000; minimised, it still does.
void expect_found(HitAnswer (*bug)(const HitCase&), size_t most_triangles) {
  const auto spoilt = [&](const HitCase& hit_case) {
    const Certificate certificate = certify(hit_case);
    return judge(hit_case, certificate, hardware_answer(hit_case)).right &&
           !judge(hit_case, certificate, bug(hit_case)).right;
  };
  uint64_t number = 0;
  while (number < 1000 && !spoilt(hard_case(1, number))) ++number;
  ASSERT_LT(number, 1000u);
  const HitCase found = hard_case(1, number), smallest = minimise(found, spoilt);
  EXPECT_TRUE(spoilt(smallest));
  EXPECT_FALSE(size_of(found) < size_of(smallest));
  EXPECT_LE(smallest.triangles.size(), most_triangles) << text_of(smallest);
}

TEST(SeededBug, AnOpenEdgeIsFoundAmongAThousandCases) { expect_found(with_an_open_edge, 2); }
TEST(SeededBug, AClosedLimitIsFoundAmongAThousandCases) { expect_found(with_a_closed_limit, 1); }
TEST(SeededBug, AWideTieIsFoundAmongAThousandCases) { expect_found(with_a_wide_tie, 2); }

TEST(OurAnswers, AreTheSameWithBoxesOfEveryWidth) {
  const auto ours = our_answers();
  const std::vector<std::string> names = ours->names();
  const auto hardware = static_cast<size_t>(std::find(names.begin(), names.end(), kHardware) - names.begin());
  std::vector<Said> answers(names.size());
  int hits = 0;
  for (uint64_t i = 0; i < 9000; ++i) {
    const HitCase hit_case = hard_case(9, i);
    ours->answer(hit_case, answers.data());
    hits += answers[hardware]->hit;
    for (size_t k = hardware + 1; k < names.size(); ++k) {
      ASSERT_EQ(answers[k]->hit, answers[hardware]->hit) << names[k] << ", case " << i;
      if (!answers[hardware]->hit) continue;
      ASSERT_EQ(answers[k]->triangle, answers[hardware]->triangle) << names[k] << ", case " << i;
      ASSERT_EQ(as_bits(answers[k]->t), as_bits(answers[hardware]->t)) << names[k] << ", case " << i;
    }
  }
  EXPECT_GT(hits, 3000);
}

}  // namespace
}  // namespace raypool::referee
