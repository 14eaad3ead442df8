var searchData=
[
  ['radix_5fsort_2ehpp_0',['radix_sort.hpp',['../radix__sort_8hpp.html',1,'']]],
  ['random_2ehpp_1',['random.hpp',['../random_8hpp.html',1,'']]],
  ['raycast_2ehpp_2',['raycast.hpp',['../raycast_8hpp.html',1,'']]],
  ['reachability_2ehpp_3',['reachability.hpp',['../reachability_8hpp.html',1,'']]],
  ['reconstruct_5fsurface_2ehpp_4',['reconstruct_surface.hpp',['../reconstruct__surface_8hpp.html',1,'']]],
  ['region_5fgrowing_2ehpp_5',['region_growing.hpp',['../region__growing_8hpp.html',1,'']]],
  ['render_2ehpp_6',['render.hpp',['../render_8hpp.html',1,'']]],
  ['report_2ehpp_7',['report.hpp',['../report_8hpp.html',1,'']]],
  ['report_5fhtml_2ehpp_8',['report_html.hpp',['../report__html_8hpp.html',1,'']]],
  ['result_2ehpp_9',['result.hpp',['../result_8hpp.html',1,'']]],
  ['results_2ehpp_10',['results.hpp',['../results_8hpp.html',1,'']]],
  ['ros_2ehpp_11',['ros.hpp',['../ros_8hpp.html',1,'']]],
  ['run_5fcell_2ehpp_12',['run_cell.hpp',['../run__cell_8hpp.html',1,'']]]
];
