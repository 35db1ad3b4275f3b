#include "cli/black_picture.hpp"

#include <algorithm>
#include <vector>

namespace raypool {

std::string why_black(const FrameBuffer& frame, const RayCounts& rays) {
  const std::vector<uint8_t> picture = to_rgb8(frame);
  if (std::any_of(picture.begin(), picture.end(), [](uint8_t value) { return value != 0; })) return "";
  const std::string black = "the picture is all black: ";
  if (rays.eye.ended == rays.eye.traced) {
    return black +
           "no ray from the eye hits anything; place the camera with --eye and --look-at, or leave the view out";
  }
  if (rays.shadow.futile == rays.shadow.traced) {
    return black +
           "no light reaches what the eye sees, which is in shadow, faces away or is black (Kd 0); move the light with "
           "--light";
  }
  return black + "what the eye sees is too dark to show; give its materials (Kd) or the view's light brighter colours";
}

}  // namespace raypool
