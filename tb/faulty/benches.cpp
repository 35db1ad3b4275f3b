#include "faulty/benches.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "isa/input_error.hpp"

namespace raypool::faulty {

namespace {

/// A fault may keep a bench from ending.
constexpr int kSecondsLimit = 1500;

}  // namespace

std::vector<Bench> read_benches(const std::string& path, const std::string& source, const std::string& folder,
                                const std::string& added) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("{}: the file cannot be read", path));
  std::vector<Bench> benches;
  try {
    const nlohmann::json all = nlohmann::json::parse(file);
    for (const auto& entry : all.at(source)) {
      Bench bench;
      bench.name = entry.at("bench").get<std::string>();
      const std::string program = folder + "/" + bench.name;
      if (access(program.c_str(), X_OK) != 0)
        throw InputError(fmt::format("{}: there is no bench {}: build it there", folder, bench.name));
      const std::string arguments = entry.contains("arguments") ? entry["arguments"].get<std::string>() + added
                                                                : fmt::format("--gtest_fail_fast '--gtest_filter={}'",
                                                                              entry.at("filter").get<std::string>());
      bench.command = fmt::format("timeout {} {} {}", kSecondsLimit, program, arguments);
      bench.tops = entry.at("tops").get<std::vector<std::string>>();
      benches.push_back(bench);
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: no list {} of {{bench, tops, filter}}: {}", path, source, error.what()));
  }
  return benches;
}

std::vector<Bench> benches_of(const std::vector<Bench>& benches, const Hierarchy& hierarchy,
                              const std::string& module) {
  std::vector<Bench> found;
  std::copy_if(benches.begin(), benches.end(), std::back_inserter(found), [&](const Bench& bench) {
    return std::any_of(bench.tops.begin(), bench.tops.end(),
                       [&](const std::string& top) { return hierarchy.contains(top, module); });
  });
  return found;
}

void run_benches(const std::vector<Bench>& benches, Outcome& outcome) {
  for (const Bench& bench : benches) {
    std::FILE* printed = popen((bench.command + " 2>&1").c_str(), "r");
    if (printed == nullptr) throw InputError(bench.command + " cannot be started");
    std::string failed;
    std::array<char, 500> line;
    while (std::fgets(line.data(), line.size(), printed) != nullptr)
      if (!failed.empty() || std::string_view(line.data()).find("FAILED") != std::string_view::npos)
        failed += line.data();
    const int status = pclose(printed);
    if (status == 0) continue;
    outcome.kind = Outcome::Kind::Bench;
    outcome.by = bench.name;
    outcome.text = failed.empty() ? fmt::format("ended with status {}", status) : failed;
    return;
  }
}

}  // namespace raypool::faulty
