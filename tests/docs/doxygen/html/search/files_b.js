var searchData=
[
  ['l515_2ehpp_0',['l515.hpp',['../l515_8hpp.html',1,'']]],
  ['limit_2ehpp_1',['limit.hpp',['../limit_8hpp.html',1,'']]],
  ['limits_2ehpp_2',['limits.hpp',['../limits_8hpp.html',1,'']]],
  ['locate_2ehpp_3',['locate.hpp',['../locate_8hpp.html',1,'']]]
];
