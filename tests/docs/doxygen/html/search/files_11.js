var searchData=
[
  ['samples_2ehpp_0',['samples.hpp',['../samples_8hpp.html',1,'']]],
  ['scan_5frecord_2ehpp_1',['scan_record.hpp',['../scan__record_8hpp.html',1,'']]],
  ['scene_2ehpp_2',['scene.hpp',['../geometry_2scene_8hpp.html',1,'(Global Namespace)'],['../io_2scene_8hpp.html',1,'(Global Namespace)']]],
  ['see_5fplanner_2ehpp_3',['see_planner.hpp',['../see__planner_8hpp.html',1,'']]],
  ['seen_5fthrough_2ehpp_4',['seen_through.hpp',['../seen__through_8hpp.html',1,'']]],
  ['selector_2ehpp_5',['selector.hpp',['../selector_8hpp.html',1,'']]],
  ['simulated_5fscan_2ehpp_6',['simulated_scan.hpp',['../simulated__scan_8hpp.html',1,'']]],
  ['sor_2ehpp_7',['sor.hpp',['../sor_8hpp.html',1,'']]],
  ['spacing_2ehpp_8',['spacing.hpp',['../spacing_8hpp.html',1,'']]],
  ['sphere_5fvoting_2ehpp_9',['sphere_voting.hpp',['../sphere__voting_8hpp.html',1,'']]],
  ['split_2ehpp_10',['split.hpp',['../split_8hpp.html',1,'']]],
  ['stencil_2ehpp_11',['stencil.hpp',['../stencil_8hpp.html',1,'']]],
  ['stopwatch_2ehpp_12',['stopwatch.hpp',['../stopwatch_8hpp.html',1,'']]],
  ['surface_5fimage_2ehpp_13',['surface_image.hpp',['../surface__image_8hpp.html',1,'']]],
  ['surfels_2ehpp_14',['surfels.hpp',['../surfels_8hpp.html',1,'']]]
];
