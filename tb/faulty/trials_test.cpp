#include "faulty/trials.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace raypool::faulty {
namespace {

Trial trial(const std::string& id, const Outcome& outcome) {
  return {id, nlohmann::ordered_json::object(), [outcome](const Note&) { return outcome; }};
}

TEST(Trials, ResumedRunOnlyWhatHasNoOutcomeAlsoWhereTwoShareAnId) {
  const std::string path = testing::TempDir() + "trials.json";
  std::filesystem::remove(path);
  TrialOptions options;
  options.json = path;
  run_trials({trial("twin", {Outcome::Kind::Difference, 3, "m", "first"}),
              trial("twin", {Outcome::Kind::Survived, 7, "m", "second"})},
             options);

  options.resume = true;
  const Outcome again = {Outcome::Kind::Hang, 1, "m", "run again"};
  const std::vector<Outcome> outcomes =
      run_trials({trial("twin", again), trial("other", again), trial("twin", again)}, options);
  ASSERT_EQ(outcomes.size(), 3u);
  EXPECT_EQ(outcomes[1].text, "run again");
  EXPECT_EQ(outcomes[0].programs + outcomes[2].programs, 10u) << "each of the kept outcomes, once";
  EXPECT_NE(outcomes[0].kind, outcomes[2].kind);
}

}  // namespace
}  // namespace raypool::faulty
