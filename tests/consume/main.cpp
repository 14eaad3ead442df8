// SPDX-License-Identifier: BSD-3-Clause
// The program of every consumer: small, of two units that share headers, and it needs all that the library needs:
// Eigen, nanoflann, threads and, with WITH_IO, files and yaml-cpp; with WITH_METHOD the method.
#include "other.hpp"

#ifdef WITH_IO
#include <agrisee/io/scene.hpp>
#endif
#ifdef WITH_METHOD
#include <agrisee/process.hpp>
#endif
#include <iostream>

int main() {
#ifdef WITH_IO
  try {
    agrisee::io::read_scene("no_such_scene.yaml");
    return 2;
  } catch (const agrisee::FileError& e) {
    std::cout << e.what() << "\n";
  }
#endif
#ifdef WITH_METHOD
  const agrisee::ScanResult nothing = agrisee::process(std::vector<Eigen::Vector3f>{});
  if (!nothing.fruits.empty()) return 3;
#endif
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 1000; ++i)
    points.emplace_back(0.001f * static_cast<float>(i % 100), 0.001f * static_cast<float>(i / 100), 0.0f);
  points.emplace_back(1.0f, 1.0f, 1.0f);
  std::cout << "agrisee " << version() << ": " << kept(points) << " of " << points.size() << " points kept\n";
  return kept(points) < points.size() && agrisee::KdTree<float>(points).count({1.0f, 1.0f, 1.0f}, 0.5f) == 1 ? 0 : 1;
}
