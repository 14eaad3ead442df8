// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/render.hpp>

#include <limits>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace {

/// The near halves of spheres in front of the robot.
ScanResult spheres(int count) {
  ScanResult r;
  Rng rng(1);
  for (int id = 1; id <= count; ++id) {
    Fruit f;
    f.id = id;
    Body b;
    b.center = {0.08 * (id - 0.5 * (count + 1)), 0.55, 0.2};
    b.radii.setConstant(0.035);
    f.body = b;
    f.centroid = b.center;
    for (int i = 0; i < 3000; ++i) {
      Eigen::Vector3d d = rng.direction();
      d.y() = -std::abs(d.y());
      r.cloud.points.push_back((b.center + 0.035 * d).cast<float>());
      r.cloud.normals.push_back(d.cast<float>());
      r.labels.push_back(id);
    }
    r.fruits.push_back(f);
  }
  for (int i = 0; i < 4; ++i) {
    View v;
    v.world_T_optical = look_along({0.1 * i - 0.15, 0.2, 0.25}, {0.15 - 0.1 * i, 0.35, -0.05});
    r.views.push_back(v);
  }
  return r;
}

Workcell cell() {
  Workcell w;
  w.name = "three spheres";
  w.scan_volume.min = {-0.17, 0.40, -0.02};
  w.scan_volume.max = {0.17, 0.72, 0.42};
  return w;
}

/// Pixels whose hue is near that color's, in columns [x0, x1).
std::size_t count_like(const io::Image& image, const io::Rgb& rgb, int x0, int x1) {
  const Eigen::Vector3d wanted = Eigen::Vector3d(rgb[0], rgb[1], rgb[2]).normalized();
  std::size_t n = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = x0; x < x1; ++x) {
      const io::Rgb& p = image.at(x, y);
      const Eigen::Vector3d c(p[0], p[1], p[2]);
      if (c.norm() > 40.0 && c.normalized().dot(wanted) > 0.995) ++n;
    }
  return n;
}

}  // namespace

TEST_CASE("a picture shows every fruit in its color, from both sides") {
  const io::Image image = io::render(spheres(3), cell(), 800, 450);
  REQUIRE(image.width == 800);
  REQUIRE(image.height == 450);
  REQUIRE(image.pixels.size() == 800u * 450u);
  for (int id = 1; id <= 3; ++id) {
    CHECK(count_like(image, io::fruit_color(id), 0, 400) > 1000);
    CHECK(count_like(image, io::fruit_color(id), 400, 800) > 80);
    CHECK(count_like(image, io::fruit_color(5), 0, 800) < 50);
  }
  // Left to right as the robot sees it: x grows to the right when it looks along y.
  const auto mean_column = [&](int id) {
    double sum = 0.0, n = 0.0;
    for (int x = 0; x < 400; ++x) {
      const auto k = static_cast<double>(count_like(image, io::fruit_color(id), x, x + 1));
      sum += k * x;
      n += k;
    }
    return sum / n;
  };
  CHECK(mean_column(1) < mean_column(2));
  CHECK(mean_column(2) < mean_column(3));
}

TEST_CASE("the number of a fruit behind another stays readable") {
  // Two fruit in one line of sight: with both numbers in one place, the ring of the first would be hidden.
  ScanResult r = spheres(2);
  r.fruits[0].id = 3;  // orange, unlike the axes of the frames
  r.fruits[1].id = 4;
  const auto ring = [&](int behind) {
    r.fruits[0].body->center = r.fruits[1].body->center + Eigen::Vector3d(0.0, 0.08 * behind, 0.0);
    r.fruits[0].centroid = r.fruits[0].body->center;
    Cloud only;  // of the second fruit, so that the color of the first is seen in its number's ring alone
    for (std::size_t i = 0; i < r.cloud.size(); ++i)
      if (r.labels[i] == 2) only.points.push_back(r.cloud.points[i]);
    ScanResult shown = r;
    shown.cloud = only;
    shown.labels.assign(only.size(), 4);
    io::Image image = io::render(shown, cell(), 1600, 900);
    image.height -= 80;  // without the legend
    return count_like(image, io::fruit_color(3), 0, 800);
  };
  const std::size_t apart = ring(0) > 0 ? ring(1) : 0;
  CHECK(apart > 40);
  CHECK(2 * ring(0) > apart);
}

TEST_CASE("pictures are the same every time, and of the size asked for") {
  const io::Image a = io::render(spheres(2), cell(), 640, 360), b = io::render(spheres(2), cell(), 640, 360);
  CHECK(a.pixels == b.pixels);
  CHECK_THROWS_AS(io::render(spheres(1), cell(), 100, 360), ParameterError);
  CHECK_THROWS_AS(io::render(spheres(1), cell(), 640, 0), ParameterError);
}

TEST_CASE("a picture shows where the fruit are, not the centroids of their points") {
  ScanResult other = spheres(2);
  for (Fruit& f : other.fruits) f.centroid.y() -= 0.02;
  CHECK(io::render(other, cell(), 640, 360).pixels == io::render(spheres(2), cell(), 640, 360).pixels);
  for (Fruit& f : other.fruits) f.body->center.y() += 0.02;
  CHECK(io::render(other, cell(), 640, 360).pixels != io::render(spheres(2), cell(), 640, 360).pixels);
}

TEST_CASE("any result can be drawn") {
  const auto draw = [](const ScanResult& r, const Workcell& w) { return io::render(r, w, 640, 360).pixels.size(); };
  CHECK(draw({}, {}) == 640u * 360u);
  CHECK(draw({}, cell()) == 640u * 360u);
  CHECK(draw(spheres(40), {}) == 640u * 360u);
  ScanResult odd = spheres(2);
  odd.cloud.points[0].x() = std::numeric_limits<float>::quiet_NaN();
  odd.cloud.points[1].y() = std::numeric_limits<float>::infinity();
  odd.cloud.points[2] = {1e30f, -1e30f, 1e30f};
  odd.cloud.normals[3].setZero();
  odd.cloud.normals[4].setConstant(std::numeric_limits<float>::quiet_NaN());
  odd.fruits[0].centroid.setConstant(std::numeric_limits<double>::quiet_NaN());
  odd.fruits[1].body->radii.setZero();
  odd.views[0].world_T_optical.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
  odd.views[1].world_T_optical.translation().x() = 1e12;
  CHECK(draw(odd, cell()) == 640u * 360u);
  CHECK(draw(odd, {}) == 640u * 360u);
  ScanResult same;
  same.cloud.points.assign(100, Eigen::Vector3f(0.1f, 0.5f, 0.2f));
  CHECK(draw(same, {}) == 640u * 360u);
  same.cloud.points.resize(1);
  CHECK(draw(same, {}) == 640u * 360u);
  ScanResult wrong = spheres(1);
  wrong.labels.pop_back();
  CHECK_THROWS_AS(io::render(wrong, cell()), InputError);
}

TEST_CASE("PNG files are whole and written atomically") {
  const TempFolder folder;
  io::write_picture(folder / "truss.png", spheres(1), cell());
  const std::string bytes = slurp(folder / "truss.png");
  REQUIRE(bytes.size() > 1000);
  CHECK(bytes.compare(0, 8, "\x89PNG\r\n\x1a\n") == 0);
  CHECK(bytes.compare(bytes.size() - 8, 4, "IEND") == 0);
  const auto big_endian = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  CHECK(big_endian(16) == 1600);
  CHECK(big_endian(20) == 900);
  io::Image image;
  CHECK_THROWS_AS(io::write_png(folder / "a.png", image), InputError);
  image.width = image.height = 2;
  image.pixels.resize(3);
  CHECK_THROWS_AS(io::write_png(folder / "a.png", image), InputError);
  image.pixels.resize(4);
  require_file_error(folder / "no/such.png", "cannot be written", [&](const auto& p) { io::write_png(p, image); });
  CHECK(folder.files() == 1);
}
