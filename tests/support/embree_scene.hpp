// SPDX-License-Identifier: BSD-3-Clause
// A mesh as Embree 3 sees it, for tests and benchmarks.
#pragma once

#include <agrisee/geometry/mesh.hpp>

#include <embree3/rtcore.h>
#include <string>

namespace agrisee::shapes {

class EmbreeScene {
 public:
  EmbreeScene(const Mesh& mesh, int threads, RTCBuildQuality quality, RTCSceneFlags flags)
      : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, flags);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                          3 * sizeof(float), mesh.vertices.size()));
    auto* t = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                             3 * sizeof(unsigned), mesh.triangles.size()));
    for (const Eigen::Vector3f& p : mesh.vertices) v = std::copy(p.data(), p.data() + 3, v);
    for (const auto& triangle : mesh.triangles) t = std::copy(triangle.begin(), triangle.end(), t);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneBuildQuality(scene_, quality);
    rtcCommitScene(scene_);
  }
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  RTCScene scene() const { return scene_; }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace agrisee::shapes
