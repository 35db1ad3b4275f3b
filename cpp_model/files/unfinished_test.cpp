#include "files/unfinished.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <vector>

#include "files/output_files.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

class Unfinished : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    tell_unfinished([this](const std::string& what) { told_.push_back(what); });
  }
  void TearDown() override {
    tell_unfinished({});
    fs::remove_all(folder_);
  }
  void leave(const std::string& name, const std::string& content = "content") const {
    std::ofstream(folder_ / name) << content;
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  /// How a process ends that does this; of 128 and more the signal.
  template <typename Action>
  static int end_of(const Action& action) {
    const pid_t child = fork();
    if (child == 0) {
      action();
      std::_Exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }
  fs::path folder_;
  std::vector<std::string> told_;
};

using Names = std::vector<std::string>;

TEST_F(Unfinished, AWaveformThatAKilledRunLeftGetsANameAndIsTold) {
  leave(".4242.waves.fst");
  leave(".4242.waves.fst.hier");
  OutputFiles files;
  files.write(folder_ / "waves.fst", "mine");
  files.publish();
  EXPECT_EQ(this->files(), (Names{"killed-4242-waves.fst", "killed-4242-waves.fst.hier", "waves.fst"}));
  ASSERT_EQ(told_.size(), 1u);
  EXPECT_EQ(told_[0],
            "a run that was killed left its waveform: it is " + (folder_ / "killed-4242-waves.fst").string() + " now");
}

TEST_F(Unfinished, OtherFilesThatAKilledRunLeftAreRemovedAndTold) {
  leave(".4242.report.json", "{\"half\":");
  leave(".7.waves.fst", "");  // nothing was written into it
  {
    OutputFiles files;
    files.clear_unfinished(folder_ / "report.json");
    files.clear_unfinished(folder_ / "waves.fst");
  }
  EXPECT_EQ(files(), Names{});
  ASSERT_EQ(told_.size(), 2u);
  EXPECT_EQ(told_[0],
            "removed " + (folder_ / ".4242.report.json").string() + ", which a run that was killed left unfinished");
}

TEST_F(Unfinished, FilesOfOtherNamesAreLeftAlone) {
  const Names others = {".4242.report.json.hier.more",
                        ".4242.report.jsonx",
                        ".42a.report.json",
                        ".report.json",
                        "4242.report.json",
                        "report.json.4242"};
  for (const std::string& name : others) leave(name);
  OutputFiles().clear_unfinished(folder_ / "report.json");
  EXPECT_EQ(files(), others);
  EXPECT_EQ(told_, Names{});
}

TEST_F(Unfinished, WhatAnotherRunStillWritesIsLeftAlone) {
  leave(".4242.waves.fst");
  {
    const FolderHold other(folder_);
    OutputFiles files;
    files.write(folder_ / "waves.fst", "mine");
    files.publish();
  }
  EXPECT_EQ(files(), (Names{".4242.waves.fst", "waves.fst"}));
  OutputFiles().clear_unfinished(folder_ / "waves.fst");
  EXPECT_EQ(files(), (Names{"killed-4242-waves.fst", "waves.fst"}));
}

TEST_F(Unfinished, WhatTheRunItselfHasBegunIsNotTakenForLeft) {
  OutputFiles files;
  files.write(folder_ / "a.fst", "first");
  files.write(folder_ / "b.fst", "second");
  files.publish();
  EXPECT_EQ(this->files(), (Names{"a.fst", "b.fst"}));
  EXPECT_EQ(told_, Names{});
}

TEST_F(Unfinished, ASignalTakesTemporaryFilesAlong) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    EXPECT_EQ(end_of([&] {
                handle_stop_signals();
                OutputFiles out;
                out.write(folder_ / "a", "half");
                raise(signal);
              }),
              128 + signal);
    EXPECT_EQ(files(), Names{}) << signal;
  }
}

TEST_F(Unfinished, AStoppedRunFinishesWhatItKeeps) {
  EXPECT_EQ(end_of([&] {
              handle_stop_signals();
              OutputFiles out;
              out.write(folder_ / "a", "whole");
              const KeepRunning keep;
              stop_point();
              raise(SIGTERM);
              raise(SIGINT);  // `timeout` sends two
              try {
                stop_point();
              } catch (const Stopped& stopped) {
                if (stopped.signal == SIGTERM) out.publish();
              }
              end_by(stop_signal());
            }),
            128 + SIGTERM);
  EXPECT_EQ(files(), Names{"a"});
}

TEST_F(Unfinished, ASecondSignalAfterAWhileEndsARunThatDoesNotStop) {
  EXPECT_EQ(end_of([&] {
              handle_stop_signals();
              const KeepRunning keep;
              raise(SIGINT);
              sleep(3);
              raise(SIGINT);
            }),
            128 + SIGINT);
}

TEST_F(Unfinished, ASignalThatIsIgnoredStaysIgnored) {
  EXPECT_EQ(end_of([&] {
              std::signal(SIGHUP, SIG_IGN);  // as nohup has it
              handle_stop_signals();
              raise(SIGHUP);
            }),
            0);
}

TEST_F(Unfinished, AChildThatIsEndedLeavesTheParentsFiles) {
  EXPECT_EQ(end_of([&] {
              handle_stop_signals();
              OutputFiles out;
              out.write(folder_ / "a", "whole");
              if (end_of([] { raise(SIGTERM); }) == 128 + SIGTERM) out.publish();
            }),
            0);
  EXPECT_EQ(files(), Names{"a"});
}

}  // namespace
}  // namespace raypool
