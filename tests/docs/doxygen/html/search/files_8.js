var searchData=
[
  ['icp_2ehpp_0',['icp.hpp',['../icp_8hpp.html',1,'']]],
  ['icp_5fparameters_2ehpp_1',['icp_parameters.hpp',['../icp__parameters_8hpp.html',1,'']]],
  ['intrinsics_2ehpp_2',['intrinsics.hpp',['../intrinsics_8hpp.html',1,'']]]
];
