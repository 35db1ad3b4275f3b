// Where the light of an automatic view is. docs/use/views.md has the rule.
#pragma once

#include "scene/enclosure.hpp"
#include "scene/scene_probe.hpp"

namespace raypool {

/// A place from which hardly anything that the camera sees is left dark, `distance` or less from the camera; or, in a
/// room, somewhere in it. `room`: null if the camera is not among the triangles.
Vec3 automatic_light(const SceneProbe& probe, const Camera& camera, double distance, const RoomBox* room);

}  // namespace raypool
