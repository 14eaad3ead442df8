var searchData=
[
  ['ur3_2ehpp_0',['ur3.hpp',['../ur3_8hpp.html',1,'']]]
];
