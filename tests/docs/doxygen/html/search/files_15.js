var searchData=
[
  ['workcell_2ehpp_0',['workcell.hpp',['../workcell_8hpp.html',1,'']]]
];
