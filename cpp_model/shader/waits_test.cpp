// Sets whose shaders wait for their rays, against a recursive renderer that runs their SPIR-V (test_paths.hpp).
#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

#include "config/data_folder.hpp"
#include "files/input_file.hpp"
#include "shader/test_paths.hpp"
#include "shader/test_random_waits.hpp"

namespace raypool::shader {
namespace {

namespace fs = std::filesystem;

void expect_same(const std::vector<std::string>& files, const std::string& name) {
  const PathSet set(files);
  Random random(5);
  World world(random);
  PathOutcome outcome;
  ASSERT_NO_FATAL_FAILURE(compare_paths(set, world, {KernelTarget(false, false), KernelTarget(false, true)}, outcome))
      << name;
  EXPECT_EQ(outcome.compiled, 4) << name;
  EXPECT_EQ(outcome.undefined, 0) << name;
  EXPECT_GT(outcome.rays, 0) << name;
  std::cout << fmt::format("{}: {} rays, {} of a path at most, {} contributions, {} spilled\n", name, outcome.rays,
                           outcome.longest, outcome.contributions, outcome.spilled);
}

// ---- the cases

std::vector<std::string> shaders_in(const fs::path& folder) {
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".rgen" || ending == ".rchit" || ending == ".rmiss" || ending == ".rcall")
      files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

class WaitingFolders : public testing::TestWithParam<const char*> {};

TEST_P(WaitingFolders, LeaveWhatTheirSpirvLeaves) {
  expect_same(shaders_in(fs::path(data_folder()) / "cpp_model/shader/cases" / GetParam()), GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, WaitingFolders,
                         testing::Values("triangle", "reflections", "shadow_inside", "bounces", "groups", "nested"),
                         [](const auto& one) { return std::string(one.param); });

// ---- sets in odd shapes

struct OddSet {
  std::string name;
  std::vector<std::pair<std::string, std::string>> files;  // names and texts
};

std::ostream& operator<<(std::ostream& out, const OddSet& set) { return out << set.name; }

/// Those of a file (waiting_sets/README.md).
void add_sets(const fs::path& file, std::vector<OddSet>& sets) {
  std::istringstream lines(read_file(file.string(), "sets"));
  std::string common;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("=== ", 0) == 0) {
      sets.push_back({line.substr(4), {}});
      common = kWaitingPrelude;
      continue;
    }
    auto& files = sets.back().files;
    if (line.rfind("--- ", 0) == 0)
      files.emplace_back(fmt::format("{}.{}", files.size(), line.substr(4)), common);
    else
      (files.empty() ? common : files.back().second) += line + '\n';
  }
}

std::vector<OddSet> odd_sets() {
  std::vector<OddSet> sets;
  const fs::path folder = fs::path(data_folder()) / "cpp_model/shader/waiting_sets";
  if (!fs::is_directory(folder)) return sets;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".txt") add_sets(entry.path(), sets);
  return sets;
}

std::vector<std::string> written(const Scratch& scratch,
                                 const std::vector<std::pair<std::string, std::string>>& files) {
  std::vector<std::string> paths;
  for (const auto& [name, text] : files) paths.push_back(scratch.write(name, text));
  return paths;
}

class OddSets : public testing::TestWithParam<OddSet> {};

TEST_P(OddSets, LeaveWhatTheirSpirvLeaves) {
  const Scratch scratch;
  expect_same(written(scratch, GetParam().files), GetParam().name);
}

INSTANTIATE_TEST_SUITE_P(All, OddSets, testing::ValuesIn(odd_sets()), [](const auto& one) { return one.param.name; });

// ---- random sets

class RandomWaitingSets : public testing::TestWithParam<uint32_t> {};

TEST_P(RandomWaitingSets, LeaveWhatTheirSpirvLeaves) {
  for (uint32_t seed = 10 * GetParam(); seed < 10 * GetParam() + 10; ++seed) {
    const Scratch scratch;
    const auto files = RandomWaits(seed).files();
    const PathSet set(written(scratch, files));
    Random random(seed);
    World world(random);
    PathOutcome outcome;
    ASSERT_NO_FATAL_FAILURE(compare_paths(set, world, {KernelTarget(false, seed % 2 != 0)}, outcome))
        << "seed " << seed << "\n"
        << files[0].second;
    EXPECT_EQ(outcome.undefined, 0) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Tens, RandomWaitingSets, testing::Range(0u, 1u));
INSTANTIATE_TEST_SUITE_P(FurtherTens, RandomWaitingSets, testing::Range(1u, 10u));

}  // namespace
}  // namespace raypool::shader
