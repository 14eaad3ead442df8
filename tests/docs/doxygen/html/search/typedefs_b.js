var searchData=
[
  ['triangle_0',['Triangle',['../triangle_8hpp.html#ab7d2a33a75e039406d5a7fbd188f89dc',1,'agrisee']]]
];
