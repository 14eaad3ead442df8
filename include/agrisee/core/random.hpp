// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Random numbers that are the same on every platform, with every standard library and for any number of threads.
#pragma once

#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee {

/// Hashes 64 bits to 64 bits: one step of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
constexpr std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// A small random number generator (SplitMix64). Different stream numbers give independent sequences for the same
/// seed: for example, each pixel of a frame draws from its own stream, so its noise does not depend on which thread
/// computes it.
class Rng {
 public:
  /// Starts the sequence of this seed, stream and substream.
  explicit Rng(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t substream = 0)
      : state_(mix(mix(mix(seed) ^ stream) ^ substream)) {}

  /// 64 random bits.
  std::uint64_t bits() {
    const std::uint64_t x = mix(state_);
    state_ += 0x9E3779B97F4A7C15ULL;
    return x;
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal, by Box-Muller. Each draw uses exactly two uniform numbers.
  double normal() {
    const double u = 1.0 - uniform();
    const double v = uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(kTwoPi * v);
  }
  /// Uniform integer in [0, n), n > 0.
  std::uint64_t below(std::uint64_t n) { return static_cast<std::uint64_t>(uniform() * static_cast<double>(n)); }
  /// A unit vector, uniformly distributed on the sphere.
  Eigen::Vector3d direction() {
    const double z = uniform(-1.0, 1.0);
    const double a = uniform(0.0, kTwoPi);
    const double s = std::sqrt(1.0 - z * z);
    return {s * std::cos(a), s * std::sin(a), z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace agrisee
