var searchData=
[
  ['occlusion_2ehpp_0',['occlusion.hpp',['../occlusion_8hpp.html',1,'']]],
  ['open3d_2ehpp_1',['open3d.hpp',['../open3d_8hpp.html',1,'']]],
  ['orient_5fnormals_2ehpp_2',['orient_normals.hpp',['../orient__normals_8hpp.html',1,'']]],
  ['overlap_2ehpp_3',['overlap.hpp',['../overlap_8hpp.html',1,'']]]
];
