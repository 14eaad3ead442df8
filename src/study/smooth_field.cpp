// SPDX-License-Identifier: BSD-3-Clause
#include "study/smooth_field.hpp"

#include <agrisee/core/random.hpp>

#include <cmath>

namespace agrisee::study {

std::vector<SmoothField::Tap> SmoothField::taps(int pixels, double step) {
  std::vector<Tap> out(static_cast<std::size_t>(pixels));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double at = static_cast<double>(i) / step, t = at - std::floor(at), s = 1.0 - t;
    const double w[4] = {s * s * s, 4.0 - 6.0 * t * t + 3.0 * t * t * t, 4.0 - 6.0 * s * s + 3.0 * s * s * s,
                         t * t * t};
    const double length = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2] + w[3] * w[3]);
    out[i].node = static_cast<std::size_t>(at);
    for (int a = 0; a < 4; ++a) out[i].weight[a] = static_cast<float>(w[a] / length);
  }
  return out;
}

SmoothField::SmoothField(const sensor::Intrinsics& k, double spacing, double fixed, const FieldStream& always,
                         const FieldStream& now)
    : columns_(taps(k.width, spacing * k.fx)), rows_(taps(k.height, spacing * k.fy)) {
  width_ = columns_.back().node + 4;
  lattice_.resize(width_ * (rows_.back().node + 4));
  Rng of_sensor(always.seed, always.view, always.field), of_view(now.seed, now.view, now.field);
  const double a = std::sqrt(fixed), b = std::sqrt(1.0 - fixed);
  for (float& node : lattice_) {
    const double first = of_sensor.normal(), second = of_view.normal();
    node = static_cast<float>(a * first + b * second);
  }
}

void SmoothField::row(int v, int u0, int u1, std::vector<float>& values) const {
  const Tap& across = rows_[static_cast<std::size_t>(v)];
  std::vector<float> line(width_, 0.0f);
  for (std::size_t a = 0; a < 4; ++a) {
    const float* const from = &lattice_[(across.node + a) * width_];
    for (std::size_t x = 0; x < width_; ++x) line[x] += across.weight[a] * from[x];
  }
  values.resize(static_cast<std::size_t>(u1 - u0));
  for (int u = u0; u < u1; ++u) {
    const Tap& tap = columns_[static_cast<std::size_t>(u)];
    const float* const n = &line[tap.node];
    values[static_cast<std::size_t>(u - u0)] =
        tap.weight[0] * n[0] + tap.weight[1] * n[1] + tap.weight[2] * n[2] + tap.weight[3] * n[3];
  }
}

}  // namespace agrisee::study
