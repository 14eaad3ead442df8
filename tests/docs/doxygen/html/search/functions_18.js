var searchData=
[
  ['y_0',['y',['../classagrisee_1_1Grid.html#a1159bd84469aaeec617679f820e7b186',1,'agrisee::Grid']]]
];
