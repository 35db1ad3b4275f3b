// Embree, for the trees that it builds and the hits that it finds.
#pragma once

#include <embree3/rtcore.h>

namespace raypool {

/// The calling thread's device, which lives as long as the thread; starting one takes longer than a small scene does.
/// It works on that thread alone, so that trees, and with them visit counts, are the same on every machine. Throws
/// std::runtime_error when Embree cannot be started.
RTCDevice embree_device();

}  // namespace raypool
