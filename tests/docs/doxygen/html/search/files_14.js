var searchData=
[
  ['version_2ehpp_0',['version.hpp',['../version_8hpp.html',1,'']]],
  ['visibility_2ehpp_1',['visibility.hpp',['../visibility_8hpp.html',1,'']]],
  ['visibility_5fgraph_2ehpp_2',['visibility_graph.hpp',['../visibility__graph_8hpp.html',1,'']]],
  ['volume_2ehpp_3',['volume.hpp',['../volume_8hpp.html',1,'']]],
  ['voxel_2ehpp_4',['voxel.hpp',['../voxel_8hpp.html',1,'']]]
];
