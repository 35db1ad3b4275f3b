#include "scene/embree_scene.hpp"

#include "scene/embree_device.hpp"

namespace raypool {
namespace {

constexpr size_t kFewTriangles = 256;

void set(RTCRay& ray, const RayQuery& query) {
  ray.org_x = query.origin.x, ray.org_y = query.origin.y, ray.org_z = query.origin.z;
  ray.dir_x = query.direction.x, ray.dir_y = query.direction.y, ray.dir_z = query.direction.z;
  ray.tnear = 0;
  ray.tfar = query.limit;
  ray.mask = 0xffffffffu;
}

}  // namespace

EmbreeScene::EmbreeScene(const Scene& scene, EmbreeMode mode) {
  const RTCDevice device = embree_device();
  scene_ = rtcNewScene(device);
  rtcSetSceneFlags(scene_, mode == EmbreeMode::Robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  // Splitting triangles pays in large scenes; and Embree ends the program where the parts are equal in floats.
  rtcSetSceneBuildQuality(scene_,
                          scene.triangles.size() < kFewTriangles ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), scene.vertices.size()));
  for (const Vec3& v : scene.vertices) *vertices++ = v.x, *vertices++ = v.y, *vertices++ = v.z;
  auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(uint32_t), scene.triangles.size()));
  for (const auto& triangle : scene.triangles) {
    for (uint32_t index : triangle) *indices++ = index;
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
}

EmbreeScene::~EmbreeScene() { rtcReleaseScene(scene_); }

bool EmbreeScene::nearest(const RayQuery& query, Hit& hit) const {
  RTCRayHit found{};
  set(found.ray, query);
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &found);
  hit.triangle = found.hit.primID;
  hit.t = found.ray.tfar;
  hit.u = found.hit.u;
  hit.v = found.hit.v;
  return found.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

bool EmbreeScene::occluded(const RayQuery& query) const {
  RTCRay ray{};
  set(ray, query);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_, &context, &ray);
  return ray.tfar < 0;
}

bool EmbreeTracer::trace(const Ray& ray, Intersection& intersection) const {
  return tracer_.answer(
      ray, intersection, [&](const RayQuery& query) { return embree_.occluded(query); },
      [&](const RayQuery& query, Hit& hit) {
        const bool met = embree_.nearest(query, hit);
        if (met) hit.normal = scene_.normal(hit.triangle);
        return met;
      });
}

}  // namespace raypool
