var searchData=
[
  ['cancellation_2ehpp_0',['cancellation.hpp',['../cancellation_8hpp.html',1,'']]],
  ['cloud_2ehpp_1',['cloud.hpp',['../cloud_8hpp.html',1,'']]],
  ['cloud_5ffile_2ehpp_2',['cloud_file.hpp',['../cloud__file_8hpp.html',1,'']]],
  ['cloud_5forigin_2ehpp_3',['cloud_origin.hpp',['../cloud__origin_8hpp.html',1,'']]],
  ['collision_2ehpp_4',['collision.hpp',['../collision_8hpp.html',1,'']]],
  ['compiled_2ehpp_5',['compiled.hpp',['../compiled_8hpp.html',1,'']]],
  ['components_2ehpp_6',['components.hpp',['../components_8hpp.html',1,'']]],
  ['contradiction_2ehpp_7',['contradiction.hpp',['../contradiction_8hpp.html',1,'']]],
  ['count_5fneighbors_2ehpp_8',['count_neighbors.hpp',['../count__neighbors_8hpp.html',1,'']]]
];
