var searchData=
[
  ['gain_5fparameters_2ehpp_0',['gain_parameters.hpp',['../gain__parameters_8hpp.html',1,'']]],
  ['gain_5fplanner_2ehpp_1',['gain_planner.hpp',['../gain__planner_8hpp.html',1,'']]],
  ['greedy_2ehpp_2',['greedy.hpp',['../greedy_8hpp.html',1,'']]],
  ['greedy_5fplanner_2ehpp_3',['greedy_planner.hpp',['../greedy__planner_8hpp.html',1,'']]],
  ['grid_2ehpp_4',['grid.hpp',['../grid_8hpp.html',1,'']]],
  ['ground_5ftruth_2ehpp_5',['ground_truth.hpp',['../io_2ground__truth_8hpp.html',1,'(Global Namespace)'],['../study_2ground__truth_8hpp.html',1,'(Global Namespace)']]]
];
