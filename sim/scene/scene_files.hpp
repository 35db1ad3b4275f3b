// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Finds the file of a scene that a user names.
#pragma once

#include <string>
#include <vector>

namespace raypool {

/// Folders in which a scene is looked for that is not where its path says: those of the environment variable SCENES,
/// separated by colons, in place of them `scenes/` in the checkout; then the project's `examples/`.
std::vector<std::string> scene_folders();

/// The path of a scene's file: `name` itself if it exists; else, unless it is absolute, the first file of that name, or
/// of that name with the ending of a scene (.obj, .gltf, .glb, .ply), here and in scene_folders(). Throws InputError,
/// which asks for the nearest names, when there is none.
std::string find_scene(const std::string& name);

}  // namespace raypool
