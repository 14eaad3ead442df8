// SPDX-License-Identifier: BSD-3-Clause
// The ten lines of the README: fruit from a cloud that you already have.
#include <agrisee/process.hpp>

#include <iostream>

std::vector<Eigen::Vector3f> my_points();

int main() {
  agrisee::Cloud cloud;
  cloud.points = my_points();  // std::vector<Eigen::Vector3f>, metres, z up
  agrisee::CloudOrigin origin;
  origin.viewpoint = Eigen::Vector3d(0.0, 0.0, 0.2);  // where they were seen from
  const agrisee::ScanResult result = agrisee::process(cloud, {}, origin);
  for (const agrisee::Fruit& fruit : result.fruits) {
    std::cout << "fruit " << fruit.id << " at " << fruit.position().transpose();
    if (fruit.body) std::cout << ", radius " << fruit.body->radii.mean();  // Parameters::paper() fits none
    std::cout << ", found by " << fruit.found_by << "\n";
  }
  return result.fruits.size() == 2 ? 0 : 1;
}

// Two touching spheres as seen from the front, in place of your sensor.
std::vector<Eigen::Vector3f> my_points() {
  std::vector<Eigen::Vector3f> points;
  for (const float x : {-0.035f, 0.035f})
    for (int i = 0; i < 2400; ++i) {
      const float z = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / 2400.0f, a = 2.3999632f * static_cast<float>(i);
      const float s = std::sqrt(1.0f - z * z);
      const Eigen::Vector3f d(s * std::cos(a), s * std::sin(a), z);
      if (d.y() < 0.2f) points.push_back(Eigen::Vector3f(x, 0.5f, 0.2f) + 0.035f * d);
    }
  return points;
}
