var searchData=
[
  ['dbscan_2ehpp_0',['dbscan.hpp',['../dbscan_8hpp.html',1,'']]],
  ['density_2ehpp_1',['density.hpp',['../density_8hpp.html',1,'']]],
  ['depth_5fframe_2ehpp_2',['depth_frame.hpp',['../depth__frame_8hpp.html',1,'']]],
  ['depth_5fnoise_2ehpp_3',['depth_noise.hpp',['../depth__noise_8hpp.html',1,'']]],
  ['direction_5fbins_2ehpp_4',['direction_bins.hpp',['../direction__bins_8hpp.html',1,'']]],
  ['directions_2ehpp_5',['directions.hpp',['../directions_8hpp.html',1,'']]]
];
