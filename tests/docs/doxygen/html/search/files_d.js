var searchData=
[
  ['neighbors_2ehpp_0',['neighbors.hpp',['../neighbors_8hpp.html',1,'']]],
  ['normals_2ehpp_1',['normals.hpp',['../normals_8hpp.html',1,'']]]
];
