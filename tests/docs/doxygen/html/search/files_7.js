var searchData=
[
  ['hash_5fgrid_2ehpp_0',['hash_grid.hpp',['../hash__grid_8hpp.html',1,'']]]
];
