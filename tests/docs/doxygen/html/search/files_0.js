var searchData=
[
  ['aabb_2ehpp_0',['aabb.hpp',['../aabb_8hpp.html',1,'']]],
  ['agrisee_2ehpp_1',['agrisee.hpp',['../agrisee_8hpp.html',1,'']]],
  ['all_5fneighbors_2ehpp_2',['all_neighbors.hpp',['../all__neighbors_8hpp.html',1,'']]],
  ['approach_2ehpp_3',['approach.hpp',['../approach_8hpp.html',1,'']]],
  ['arm_5fapproach_2ehpp_4',['arm_approach.hpp',['../arm__approach_8hpp.html',1,'']]],
  ['arm_5freach_2ehpp_5',['arm_reach.hpp',['../arm__reach_8hpp.html',1,'']]]
];
