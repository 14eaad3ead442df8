// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/results.hpp>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

TEST_CASE("views.csv needs numbers and positions alone") {
  const TempFolder folder;
  const std::vector<View> views = io::read_views(folder.file("views.csv", "view,x,y,z\n0,1,2,3\n 1 , 4, 5, -6e-1\n"));
  REQUIRE(views.size() == 2);
  CHECK(views[0].world_T_optical.translation() == Eigen::Vector3d(1, 2, 3));
  CHECK(views[1].world_T_optical.translation() == Eigen::Vector3d(4, 5, -0.6));
  CHECK(views[1].world_T_optical.linear().isIdentity());
  CHECK_FALSE(views[0].joints);
  CHECK(views[0].points_in == 0);
}

TEST_CASE("views.csv may come from a spreadsheet") {
  const TempFolder folder;
  for (const char* text :
       {"\xEF\xBB\xBFview,x,y,z\r\n0,1,2,3\r\n", "view;x;y;z\n0;1;2;3\n", "\xEF\xBB\xBFview;x;y;z\r\n0;1;2;3\r\n"}) {
    const std::vector<View> views = io::read_views(folder.file("views.csv", text));
    REQUIRE(views.size() == 1);
    CHECK(views[0].world_T_optical.translation() == Eigen::Vector3d(1, 2, 3));
  }
}

TEST_CASE("groups of columns in views.csv are whole or absent") {
  const TempFolder folder;
  const auto refused = [&](const std::string& head, const std::string& what) {
    require_file_error(folder.file("views.csv", head + "\n"), what, [](const auto& p) { io::read_views(p); });
  };
  refused("view,x,y", ":1: no column 'z'");
  refused("x,y,z", "no column 'view'");
  refused("view,x,y,z,qx,qy,qz", "no column 'qw'");
  refused("view,x,y,z,q1,q2,q3,q4,q5", "no column 'q6'");
  refused("view,x,y,z,oy", "no column 'ox'");
  refused("view,x,y,z\n1,0,0,0", ":2: view: expected 0");
  refused("view,x,y,z\n0,0,0,nan", ":2: z: 'nan' is not a number");
  refused("view,x,y,z\n0,0,0", ":2: expected 4 cells, got 3");
  refused("view,x,y,z,points_in\n0,0,0,0,", ":2: points_in: '' is not a count");
}
