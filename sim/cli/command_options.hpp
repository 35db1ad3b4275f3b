// Options that several commands take, as CLI11 has them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/scene_loading.hpp"

namespace raypool {

/// --set, which may be given several times.
CLI::Option* add_set(CLI::App& app, std::vector<std::string>& set);
/// --config and --set.
void add_config(CLI::App& app, std::string& config, std::vector<std::string>& set);
void add_threads(CLI::App& app, uint32_t& threads, const std::string& whose);
/// What is drawn, and how it is seen.
void add_scene(CLI::App& app, std::string& scene, std::string& size, std::string& view, ViewWords& look,
               double& detail);
void add_units_and_depth(CLI::App& app, int& units, int& depth);
/// --engine, and --unit-library.
CLI::Option* add_engine(CLI::App& app, std::string& engine, std::string& library);
void add_inspect(CLI::App& app, uint64_t& until);

}  // namespace raypool
