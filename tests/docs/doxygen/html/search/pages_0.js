var searchData=
[
  ['agrisee_0',['AgriSEE',['../index.html',1,'']]]
];
