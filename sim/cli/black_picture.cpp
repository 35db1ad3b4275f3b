#include "cli/black_picture.hpp"

#include <algorithm>
#include <vector>

namespace raypool {

namespace {

std::string why_nothing_is_seen(const Scene& scene, EyeOf eye) {
  size_t flat = 0;
  for (size_t i = 0; i < scene.triangles.size(); ++i) flat += is_degenerate(scene, i);
  if (flat == scene.triangles.size())
    return "no triangle of the scene has an area, so that no ray hits any; correct its coordinates";
  const std::string nothing = "no ray from the eye hits anything; place the camera with --eye and --look-at";
  if (eye == EyeOf::User) return nothing + ", or leave the view out";
  if (eye == EyeOf::File) return nothing + ": the one in the file looks past the scene";
  return nothing + ", or scale the scene: the view chosen for it shows no triangle, as they are very small";
}

}  // namespace

std::string why_black(const FrameBuffer& frame, const RayCounts& rays, const Scene& scene, EyeOf eye, bool shaders) {
  const std::vector<uint8_t> picture = to_rgb8(frame);
  if (std::any_of(picture.begin(), picture.end(), [](uint8_t value) { return value != 0; })) return "";
  const std::string black = "the picture is all black: ";
  if (shaders && rays.eye.traced == 0)
    return black + "its shaders trace no ray; look at what switches them off (specialization constants, for instance)";
  if (rays.eye.ended == rays.eye.traced) return black + why_nothing_is_seen(scene, eye);
  if (shaders) return black + "its shaders add nothing to it that is light enough to show; look at what they store";
  if (rays.shadow.futile == rays.shadow.traced) {
    return black +
           "no light reaches what the eye sees, which is in shadow, faces away or is black (Kd 0); move the light with "
           "--light";
  }
  return black + "what the eye sees is too dark to show; give its materials (Kd) or the view's light brighter colours";
}

}  // namespace raypool
