// Frames that a shader set draws, in place of the built-in kernels. docs/use/shaders.md has what they are given.
#pragma once

#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/engine.hpp"
#include "cli/report.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/shader_memory.hpp"
#include "shader/shader_set.hpp"

namespace raypool {

/// Throws InputError for what does not go together with shaders, or not without them.
void check_shaders(const SimOptions& options, Engine engine);

/// The same of the machine that draws.
void check_shaders(const RunRecord& record);

/// Adds to the settings what the set's machine must have, unless they say otherwise: a user of the set need not know
/// it, and the machine's name shows it.
void add_settings_for(const shader::ShaderSet& set, int units, std::vector<std::string>& settings);

/// The memory of a frame that the set draws; the record gets its kernels, compiled for the machine of the record.
/// Throws InputError for what the set or the machine lacks.
MemoryImage build_shader_image(const ShaderSource& source, const shader::ShaderSet& set, const Scene& scene,
                               RunRecord& record);

/// "mirrors-1a2b3c4d": the last name of the folder's path and a hash of its files. Throws InputError when one of them
/// cannot be read.
std::string name_of_shaders(const std::string& folder);

}  // namespace raypool
