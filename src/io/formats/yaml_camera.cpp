// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/yaml_camera.hpp"

#include "io/formats/text.hpp"

namespace agrisee::io {

double positive(const YamlValue& value) {
  const double x = value.number();
  if (!(x > 0.0)) value.fail("must be positive, got " + format(x));
  return x;
}

int pixels(const YamlValue& value) {
  constexpr long long kMost = 16384;
  const long long n = value.integer();
  if (n < 1 || n > kMost)
    value.fail("must be from 1 to " + std::to_string(kMost) + " pixels, got " + std::to_string(n));
  return static_cast<int>(n);
}

Eigen::Vector2d read_range(const YamlValue& value) {
  const Eigen::Vector2d range = value.numbers<2>();
  if (!(range[0] >= 0.0 && range[0] < range[1])) value.fail("expected 0 <= minimum < maximum");
  if (range[0] > 50.0) value.fail("begins at " + format(range[0]) + " m: is it in millimetres?");
  return range;
}

Aabb read_volume(const YamlValue& value) {
  value.check_keys({"min", "max"});
  Aabb volume;
  volume.min = value.at("min").numbers<3>();
  volume.max = value.at("max").numbers<3>();
  for (int a = 0; a < 3; ++a)
    if (!(volume.min[a] < volume.max[a]))
      value.fail(std::string("min must be below max, but along ") + "xyz"[a] + " min is " + format(volume.min[a]) +
                 " and max " + format(volume.max[a]));
  constexpr double kLargest = 50.0;  // m
  if (volume.size().maxCoeff() > kLargest)
    value.fail("is " + format(volume.size().maxCoeff()) +
               " m long: is it in millimetres? Lengths have to be in metres");
  return volume;
}

}  // namespace agrisee::io
