var searchData=
[
  ['matching_2ehpp_0',['matching.hpp',['../matching_8hpp.html',1,'']]],
  ['measured_5fvolume_2ehpp_1',['measured_volume.hpp',['../measured__volume_8hpp.html',1,'']]],
  ['merge_2ehpp_2',['merge.hpp',['../merge_8hpp.html',1,'']]],
  ['mesh_2ehpp_3',['mesh.hpp',['../mesh_8hpp.html',1,'']]],
  ['mesh_5ffile_2ehpp_4',['mesh_file.hpp',['../mesh__file_8hpp.html',1,'']]],
  ['mesh_5fmoments_2ehpp_5',['mesh_moments.hpp',['../mesh__moments_8hpp.html',1,'']]],
  ['metrics_2ehpp_6',['metrics.hpp',['../metrics_8hpp.html',1,'']]],
  ['mount_2ehpp_7',['mount.hpp',['../mount_8hpp.html',1,'']]]
];
