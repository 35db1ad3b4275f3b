#include "sampled/processes.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "isa/input_error.hpp"

namespace raypool::sampled {
namespace {

TEST(InProcesses, ReturnsWhatEachTaskReturnsInTheirOrder) {
  const std::string large(1 << 20, 'x');  // more than a pipe holds
  for (const uint32_t at_a_time : {1u, 2u, 9u}) {
    std::vector<size_t> done;
    const std::vector<std::string> results = in_processes(
        5, at_a_time, [&](size_t task) { return std::to_string(task) + (task == 3 ? large : ""); },
        [&](size_t task, const std::string& result) {
          EXPECT_EQ(result.substr(0, 1), std::to_string(task));
          done.push_back(task);
        });
    EXPECT_EQ(results, (std::vector<std::string>{"0", "1", "2", "3" + large, "4"}));
    if (at_a_time > 1) std::sort(done.begin(), done.end());
    EXPECT_EQ(done, (std::vector<size_t>{0, 1, 2, 3, 4}));
  }
  EXPECT_TRUE(in_processes(0, 2, [](size_t) { return std::string(); }).empty());
}

TEST(InProcesses, ChangesNothingOfThisOne) {
  int number = 1;
  const std::vector<std::string> results = in_processes(2, 1, [&](size_t) { return std::to_string(++number); });
  EXPECT_EQ(results, (std::vector<std::string>{"2", "2"}));
  EXPECT_EQ(number, 1);
}

template <typename Error>
std::string error_of(const std::function<std::string(size_t)>& work) {
  try {
    in_processes(3, 2, work);
  } catch (const Error& error) {
    return error.what();
  }
  return "no such error";
}

TEST(InProcesses, PassesErrorsOn) {
  EXPECT_EQ(error_of<InputError>([](size_t task) -> std::string {
              if (task == 1) throw InputError("task 1 is bad");
              return "";
            }),
            "task 1 is bad");
  EXPECT_EQ(error_of<std::runtime_error>([](size_t task) -> std::string {
              if (task == 2) throw std::logic_error("task 2 has failed");
              return "";
            }),
            "task 2 has failed");
}

TEST(InProcesses, ReportsHowAProcessEnded) {
  EXPECT_EQ(error_of<std::runtime_error>([](size_t task) -> std::string {
              if (task == 0) raise(SIGKILL);
              return "";
            }),
            "the process of a part of the sample was ended by signal 9 (Killed)");
  EXPECT_EQ(error_of<std::runtime_error>([](size_t task) -> std::string {
              if (task == 0) _exit(7);
              return "";
            }),
            "the process of a part of the sample ended with 7");
}

TEST(InProcesses, EndsTheOthersWhenOneFails) {
  const std::string error = error_of<InputError>([](size_t task) -> std::string {
    if (task == 0) throw InputError("the first");
    for (;;) pause();
  });
  EXPECT_EQ(error, "the first");  // and it has come back at all
}

}  // namespace
}  // namespace raypool::sampled
