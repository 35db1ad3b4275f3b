#include "scene/embree_device.hpp"

#include <memory>
#include <stdexcept>

namespace raypool {

RTCDevice embree_device() {
  thread_local const std::unique_ptr<RTCDeviceTy, void (*)(RTCDevice)> device(rtcNewDevice("threads=1"),
                                                                              rtcReleaseDevice);
  if (!device) throw std::runtime_error("Embree cannot be started; check its installation");
  return device.get();
}

}  // namespace raypool
