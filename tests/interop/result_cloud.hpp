// SPDX-License-Identifier: BSD-3-Clause
// A cloud.ply as a scan leaves it, for programs of others to read and write.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/io/palette.hpp>
#include <agrisee/io/ply.hpp>

#include "catch.hpp"

namespace agrisee::test {

/// A result's cloud of 12 fruit and what is none, as a file of its own that goes when this does.
struct ResultCloud {
  Cloud cloud;
  Labels labels;
  std::filesystem::path file, copy;

  explicit ResultCloud(const std::string& name)
      : file(std::filesystem::temp_directory_path() / (name + ".ply")), copy(file) {
    copy.replace_extension("copy.ply");
    Rng rng(3);
    for (int i = 0; i < 500; ++i) {
      cloud.points.emplace_back((0.4 * rng.direction()).cast<float>());
      cloud.normals.emplace_back(rng.direction().cast<float>());
      labels.push_back(i % 13);
    }
    io::write_ply(file, cloud, labels);
  }
  ~ResultCloud() {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    std::filesystem::remove(copy, ignored);
  }
  ResultCloud(const ResultCloud&) = delete;
  ResultCloud& operator=(const ResultCloud&) = delete;

  io::Rgb color(std::size_t i) const { return io::fruit_color(labels[i]); }
};

}  // namespace agrisee::test
