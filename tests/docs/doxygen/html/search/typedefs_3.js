var searchData=
[
  ['index_0',['Index',['../types_8hpp.html#aafb0bd1bf5d685234fc86ffa5f8a54b8',1,'agrisee']]],
  ['indices_1',['Indices',['../types_8hpp.html#a8a3a24ee8fc44c8494f5a2762a235838',1,'agrisee']]]
];
