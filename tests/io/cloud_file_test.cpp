// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/cloud_file.hpp>
#include <agrisee/io/ply.hpp>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace {

io::CloudFile load(const std::filesystem::path& path) { return io::read_cloud(path); }

/// An NPY file with these numbers as floats.
std::string npy(const std::string& shape, const std::vector<float>& values, bool fortran = false) {
  std::string header =
      "{'descr': '<f4', 'fortran_order': " + std::string(fortran ? "True" : "False") + ", 'shape': " + shape + ", }\n";
  std::string out = std::string("\x93NUMPY\1\0", 8) + bytes_of(static_cast<std::uint16_t>(header.size())) + header;
  for (const float value : values) out += bytes_of(value);
  return out;
}

const std::vector<Eigen::Vector3f> kTwo{{1.0f, 2.0f, 3.0f}, {4.0f, 5.0f, -6.5f}};

}  // namespace

TEST_CASE("tables of numbers, whatever separates them") {
  const TempFolder folder;
  for (const char* text :
       {"1 2 3\n4 5 -6.5\n", "1,2,3\n4,5,-6.5", "1;2;3\r\n4; 5 ;-6.5\r\n", "\t1\t2  3\n\n 4 5 -65e-1 \n",
        "# made by hand\n1 2 3\n// more\n4 5 -6.5\n", "1 2 3 255 0 0\n4 5 -6.5 0 255 0\n", "X,Y,Z\n1,2,3\n4,5,-6.5\n",
        "//X Y Z R\n1 2 3 9\n4 5 -6.5 9\n", "z;name;\"x\";y\n3;\"a b\";1;2\n-6.5;b;4;5\n",
        "\xEF\xBB\xBFx,y,z\r\n1,2,3\r\n4,5,-6.5\r\n",
        "\xEF\xBB\xBF"
        "1;2;3\n4;5;-6.5\n"}) {
    INFO(text);
    for (const char* name : {"a.xyz", "a.csv", "a.txt", "a"}) {
      const io::CloudFile file = io::read_cloud(folder.file(name, text));
      CHECK(file.cloud.points == kTwo);
      CHECK(file.cloud.normals.empty());
      CHECK(file.width == 2);
      CHECK(file.height == 1);
    }
  }
}

TEST_CASE("the named columns of a table mean what the properties of a PLY file mean") {
  const TempFolder folder;
  const auto path = folder.file("a.csv",
                                "x,y,z,nx,ny,nz,view,label,color\n"
                                "1,2,3,0,0,2,4,7,red\n"
                                ",,,0,0,1,1,1,red\n"
                                "4,5,-6.5,0,0,0,0,-1,blue\n");
  const io::CloudFile file = io::read_cloud(path);
  CHECK(file.cloud.points == kTwo);
  CHECK(file.dropped == 1);
  CHECK(file.cloud.normals == std::vector<Eigen::Vector3f>{{0, 0, 1}, {0, 0, 0}});
  CHECK(file.cloud.views == std::vector<int>{4, 0});
  CHECK(file.instance == Labels{7, -1});
  CHECK(io::read_cloud(path, io::NonFinite::keep).cloud.size() == 3);
}

TEST_CASE("arrays of numpy are clouds") {
  const TempFolder folder;
  CHECK(io::read_cloud(folder.file("a.npy", npy("(2, 3)", {1, 2, 3, 4, 5, -6.5f}))).cloud.points == kTwo);
  CHECK(io::read_cloud(folder.file("a", npy("(2, 4)", {1, 2, 3, 0, 4, 5, -6.5f, 0}))).cloud.points == kTwo);
  CHECK(io::read_cloud(folder.file("a.npy", npy("(2, 3)", {1, 4, 2, 5, 3, -6.5f}, true))).cloud.points == kTwo);
  const io::CloudFile organized =
      io::read_cloud(folder.file("a.npy", npy("(2, 1, 3)", {1, 2, 3, 4, 5, -6.5f})), io::NonFinite::keep);
  CHECK(organized.cloud.points == kTwo);
  CHECK(organized.width == 1);
  CHECK(organized.height == 2);
  CHECK(io::read_cloud(folder.file("a.npy", npy("(0, 3)", {}))).cloud.empty());
  require_file_error(folder.file("a.npy", npy("(3, 2)", {1, 2, 3, 4, 5, 6})), "(points, 3)", load);
  require_file_error(folder.file("a.npy", npy("(3, 20)", std::vector<float>(60))), "x, y and z are its last axis",
                     load);
  require_file_error(folder.file("a.csv", "view,x,y,z,points_new\n0,1,2,3,4\n"), "lists the views", load);
  require_file_error(folder.file("a.npy", npy("(6,)", {1, 2, 3, 4, 5, 6})), "shape (6,)", load);
  require_file_error(folder.file("a.npy", npy("(3, 3)", {1, 2, 3, 4, 5, 6})), "needs 9 numbers, there are 6", load);
  require_file_error(folder.file("a.npy", "damaged"), "not an NPY file", load);
}

TEST_CASE("what is no table of points is refused with the line") {
  const TempFolder folder;
  require_file_error(folder.file("a.csv", ""), "empty", load);
  require_file_error(folder.file("a.csv", "x,y,w\n1,2,3\n"), "neither a line that names", load);
  require_file_error(folder.file("a.xyz", "1 2\n"), "neither a line that names", load);
  require_file_error(folder.file("a.csv", "x,y,z,x\n1,2,3,9\n"), ":1: two columns are called 'x'", load);
  require_file_error(folder.file("a.csv", "# made by hand\nx;y;z;View;nx;view\n1;2;3;0;0;1\n"),
                     ":2: two columns are called 'view'", load);
  CHECK(load(folder.file("a.csv", "x,y,z,note,,note,\n1,2,3,a,,b,\n")).cloud.size() == 1);  // none of them is read
  require_file_error(folder.file("a.xyz", "1 2 3\n1 2\n"), ":2: expected 3 numbers, got 2", load);
  require_file_error(folder.file("a.csv", "x,y,z\n1,2,3\n1,two,3\n"), ":3: y: 'two' is not a number", load);
  require_file_error(folder.file("a.csv", "x,y,z,view\n1,2,3,0.5\n"), ":2: view: '0.5' is not a number that can", load);
  require_file_error(folder.file("a.csv", "x,y,z,view\n1,2,3,\n"), ":2: view: '' is not a number", load);
  require_file_error(folder.file("a.pdf", "%PDF-1.4\n1 0 obj\n"), "neither PLY, PCD or NPY nor a table", load);
  require_file_error(folder.path(), "is a directory", load);
  survive_damage(folder, "a.csv", "x,y,z,nx,ny,nz,view\n1,2,3,0,0,2,4\n4,5,-6.5,0,0,0,0\n", load);
}

TEST_CASE("the first bytes decide, not the name") {
  const TempFolder folder;
  Cloud cloud;
  cloud.points = kTwo;
  io::write_raw_ply(folder / "a.csv", cloud);
  CHECK(io::read_cloud(folder / "a.csv").cloud.points == kTwo);
}
