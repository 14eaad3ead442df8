var searchData=
[
  ['base_5fsearch_2ehpp_0',['base_search.hpp',['../base__search_8hpp.html',1,'']]],
  ['baseline_5fplanners_2ehpp_1',['baseline_planners.hpp',['../baseline__planners_8hpp.html',1,'']]],
  ['bodies_2ehpp_2',['bodies.hpp',['../bodies_8hpp.html',1,'']]],
  ['bvh_2ehpp_3',['bvh.hpp',['../bvh_8hpp.html',1,'']]],
  ['bvh_5fbuild_2ehpp_4',['bvh_build.hpp',['../bvh__build_8hpp.html',1,'']]]
];
