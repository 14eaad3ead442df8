var searchData=
[
  ['cell_0',['Cell',['../classagrisee_1_1Grid.html#a5776a4ff8846f81aad8da38e5515e127',1,'agrisee::Grid']]],
  ['cellindex_1',['CellIndex',['../hash__grid_8hpp.html#ab05366353c4ed1d8ba0a61a740fdfd04',1,'agrisee']]],
  ['cloud_2',['Cloud',['../cloud_8hpp.html#a6098ca5b8e56e63341e0f775e0d4eabc',1,'agrisee']]]
];
