// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Writes a random set of shaders that wait for their rays, with its shaders.json, into a folder:
//   raypool_random_set SEED FOLDER
// scripts/tests/random_shaders.sh draws with them.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "shader/test_random_waits.hpp"

namespace {

using Json = nlohmann::ordered_json;

/// Multiples of 1/8 from -4 to 4.
Json floats(raypool::Random& random, int count) {
  Json numbers = Json::array();
  for (int i = 0; i < count; ++i) numbers.push_back((static_cast<double>(random() % 65) - 32) / 8);
  return numbers;
}

Json integers(raypool::Random& random, int count) {
  Json numbers = Json::array();
  for (int i = 0; i < count; ++i) numbers.push_back(random() % 4);
  return numbers;
}

/// What the bindings of kWaitingPrelude hold.
Json bindings(raypool::Random& random) {
  Json table = floats(random, 64);
  for (const Json& code : integers(random, 16)) table.push_back(code);
  return Json::array({
      {{"set", 0},
       {"binding", 2},
       {"values", {{"floats", floats(random, 16)}, {"ints", integers(random, 8)}, {"turn", floats(random, 9)}}}},
      {{"set", 0}, {"binding", 3}, {"holds", {{"words", table}}}},
      {{"set", 0}, {"binding", 4}, {"holds", "textures"}},
      {{"set", 0}, {"binding", 5}, {"holds", {{"floats", floats(random, 32)}}}},
  });
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    fmt::print(stderr, "usage: raypool_random_set SEED FOLDER\n");
    return 1;
  }
  const auto seed = static_cast<uint32_t>(std::stoul(words[1]));
  const std::filesystem::path folder = words[2];
  std::filesystem::create_directories(folder);
  for (const auto& [name, text] : raypool::shader::RandomWaits(seed).files()) std::ofstream(folder / name) << text;
  raypool::Random random(seed);
  std::ofstream(folder / "shaders.json") << Json{{"bindings", bindings(random)}}.dump(2) << "\n";
  return 0;
}
