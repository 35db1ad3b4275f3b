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
CLI::Option* add_threads(CLI::App& app, uint32_t& threads, const std::string& whose);
/// What is drawn, and how it is seen.
void add_scene(CLI::App& app, std::string& scene, std::string& size, std::string& view, ViewWords& look,
               double& detail);
void add_shaders(CLI::App& app, std::string& shaders);
void add_samples(CLI::App& app, int& samples);
void add_depth(CLI::App& app, int& depth);
void add_units(CLI::App& app, int& units);
void add_traverser(CLI::App& app, std::string& traverser);
/// The engines of a frame, and those of a program.
inline constexpr char kEnginesOfFrames[] = "native|estimate|functional|sampled|model|rtl|lockstep";
inline constexpr char kEnginesOfPrograms[] = "functional|model|rtl|lockstep";
/// --engine, one of `names`, and --unit-library.
void add_engine(CLI::App& app, std::string& engine, std::string& library, const std::string& names);
void add_inspect(CLI::App& app, uint64_t& until);

}  // namespace raypool
