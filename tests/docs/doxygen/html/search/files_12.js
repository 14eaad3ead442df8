var searchData=
[
  ['tiles_2ehpp_0',['tiles.hpp',['../tiles_8hpp.html',1,'']]],
  ['traced_5fscene_2ehpp_1',['traced_scene.hpp',['../traced__scene_8hpp.html',1,'']]],
  ['traits_2ehpp_2',['traits.hpp',['../traits_8hpp.html',1,'']]],
  ['triangle_2ehpp_3',['triangle.hpp',['../triangle_8hpp.html',1,'']]],
  ['truss_2ehpp_4',['truss.hpp',['../truss_8hpp.html',1,'']]],
  ['truss_5flayout_2ehpp_5',['truss_layout.hpp',['../truss__layout_8hpp.html',1,'']]],
  ['truss_5fmesh_2ehpp_6',['truss_mesh.hpp',['../truss__mesh_8hpp.html',1,'']]],
  ['truss_5fparts_2ehpp_7',['truss_parts.hpp',['../truss__parts_8hpp.html',1,'']]],
  ['types_2ehpp_8',['types.hpp',['../types_8hpp.html',1,'']]]
];
