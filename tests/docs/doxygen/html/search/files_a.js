var searchData=
[
  ['kdtree_2ehpp_0',['kdtree.hpp',['../kdtree_8hpp.html',1,'']]]
];
